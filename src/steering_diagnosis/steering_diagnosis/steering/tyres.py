"""The vehicle model's rack force along a measured motion of the rack."""

from __future__ import annotations

from collections.abc import Mapping
from functools import cache
from types import ModuleType

import numpy as np

from steering_core.parameters import ParameterSet
from steering_core.specialise import specialised_module
from steering_diagnosis.steering.kernels import load as nominal_kernel
from steering_plant.effects import EFFECTS
from steering_plant.effects.models import vehicle_model
from vehicle_model.loads import make_load
from vehicle_model.model import slots, step
from vehicle_model.vehicle import Vehicle

EFFECT = "tyre_relaxation"


def tyre_force(
    position: np.ndarray, parameters: ParameterSet, relaxation: Mapping[str, float] | None
) -> np.ndarray:
    """Return the bicycle's rack force [N] along ``position`` (n,) [m], from straight ahead."""
    kernel, model, values, rests = _model()
    given = EFFECTS[EFFECT].neutral() | dict(relaxation or {})
    values = np.array([given[name] for name in EFFECTS[EFFECT].parameters])
    vehicle = Vehicle(parameters, make_load("bicycle"), 1, model, values, rests)
    force = np.empty(len(position))
    kernel.tyre_force(
        vehicle.par, vehicle.external, vehicle.effects, vehicle.state, vehicle.out, position, force
    )
    return force


@cache
def _model() -> tuple[ModuleType, ModuleType, np.ndarray, tuple[float, ...]]:
    model, values, rests = vehicle_model({EFFECT: EFFECTS[EFFECT].neutral()}, slots, step)
    kernel = specialised_module(nominal_kernel, {"vehicle_model.model.step": model.__name__})
    return kernel, model, values, rests
