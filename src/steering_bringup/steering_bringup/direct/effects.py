"""The direct loop compiled for the models that chosen effects make."""

from __future__ import annotations

from types import ModuleType

from steering_bringup.direct import loop
from steering_core.specialise import specialised_module


def loop_for(plant_step: ModuleType, vehicle_step: ModuleType) -> ModuleType:
    """Return the loop that steps these models; the nominal loop for the nominal ones."""
    nominal = {"steering_plant.model.step": plant_step, "vehicle_model.model.step": vehicle_step}
    others = {old: new.__name__ for old, new in nominal.items() if new.__name__ != old}
    return specialised_module(loop, others) if others else loop
