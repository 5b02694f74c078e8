"""Every study by name. Register a new one here, and only here."""

from __future__ import annotations

from steering_studies.beyond import (
    end_of_stroke,
    energy,
    heavy_vehicle,
    losses,
    sensorless,
    solenoid,
    supply_unit,
    two_stage,
)
from steering_studies.beyond.study import Study

STUDIES: dict[str, Study] = {
    module.STUDY.name: module.STUDY
    for module in (
        energy,
        solenoid,
        supply_unit,
        end_of_stroke,
        losses,
        heavy_vehicle,
        sensorless,
        two_stage,
    )
}
