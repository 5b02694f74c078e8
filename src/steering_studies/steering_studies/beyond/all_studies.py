"""Every study by name. Register a new one here, and only here."""

from __future__ import annotations

from steering_studies.beyond import energy, heavy_vehicle
from steering_studies.beyond.study import Study

STUDIES: dict[str, Study] = {module.STUDY.name: module.STUDY for module in (energy, heavy_vehicle)}
