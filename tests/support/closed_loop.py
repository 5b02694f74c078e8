"""A short closed loop with effects, for tests."""

from __future__ import annotations

from collections.abc import Mapping

import vehicle_model.model.slots as vehicle_slots
import vehicle_model.model.step as vehicle_step
from driver_model.driver import Driver
from driver_model.manoeuvres import make_manoeuvre
from pressure_control.controller import ValveController
from steering_bringup.direct.effects import loop_for
from steering_bringup.direct.runner import Cores, DirectTrace, run
from steering_core.parameters import load_parameters
from steering_plant.effects.models import vehicle_model
from steering_plant.plant import Plant
from vehicle_model.loads import LOADS
from vehicle_model.vehicle import Vehicle

Effects = Mapping[str, Mapping[str, float]]


def cores(effects: Effects, valve_system: str, ticks: int) -> Cores:
    """Return fresh cores: one second of weaving at 70 km/h."""
    parameters = load_parameters()
    plant = Plant(parameters, valve_system, effects=effects)
    rolling = vehicle_model(effects, vehicle_slots, vehicle_step)
    closed = valve_system == "closed_centre"
    manoeuvre = make_manoeuvre("on_centre", duration_s=1.0)
    return Cores(
        plant,
        Driver(parameters, manoeuvre, ticks),
        Vehicle(parameters, LOADS["bicycle"](), ticks, *rolling),
        ValveController(parameters, "left") if closed else None,
        ValveController(parameters, "right") if closed else None,
        loop_for(plant.model, rolling[0]),
    )


def trace(effects: Effects, valve_system: str, ticks: int = 1000) -> DirectTrace:
    """Run the loop with ``effects`` and return its trace."""
    return run(cores(effects, valve_system, ticks), ticks)
