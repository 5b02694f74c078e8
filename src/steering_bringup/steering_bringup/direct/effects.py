"""The direct loop compiled for the models that chosen effects make, and for other controllers."""

from __future__ import annotations

from types import ModuleType

from pressure_control import controller
from steering_bringup.direct import loop
from steering_core.specialise import specialised_module


def loop_for(
    plant_step: ModuleType, vehicle_step: ModuleType, control: ModuleType = controller
) -> ModuleType:
    """Return the loop that steps these models; the nominal loop for the nominal ones.

    control: module of the valve controllers, with a kernel ``controller_step``.
    """
    nominal = {
        "steering_plant.model.step": plant_step,
        "vehicle_model.model.step": vehicle_step,
        "pressure_control.controller": control,
    }
    others = {old: new.__name__ for old, new in nominal.items() if new.__name__ != old}
    return specialised_module(loop, others) if others else loop
