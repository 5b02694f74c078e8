"""The plant's and the vehicle's models with chosen effects, compiled once for each set."""

from __future__ import annotations

import importlib
from collections.abc import Mapping
from types import MappingProxyType, ModuleType
from typing import Any

import numpy as np

from steering_core.specialise import specialised_package
from steering_plant.effects.compose import Composition, chosen, compose
from steering_plant.model import slots, states, step

NO_EFFECTS: Mapping[str, Mapping[str, Any]] = MappingProxyType({})

PLANT_SIGNALS = (
    {name: f"y[{i}]" for i, name in enumerate(states.OPEN_CENTRE_NAMES)}
    | {name: f"y[{i}]" for i, name in enumerate(states.SERVO_VALVE_NAMES)}
    | {name: f"y[{i}]" for i, name in enumerate(states.CLOSED_CENTRE_NAMES)}
    | {name: f"u[{i}]" for i, name in enumerate(states.INPUT_NAMES)}
)
"""States and held inputs that an effect in the plant may ask for, by name."""


def plant_model(effects: Mapping[str, Mapping[str, Any]]) -> tuple[ModuleType, Composition]:
    """Return the plant's step module with ``effects`` and what they add to data and state."""
    added = compose(chosen(effects, "plant"), slots, PLANT_SIGNALS)
    return _with_slots(step, added.slots), added


def vehicle_model(
    effects: Mapping[str, Mapping[str, Any]], nominal_slots: ModuleType, nominal_step: ModuleType
) -> tuple[ModuleType, np.ndarray, tuple[float, ...]]:
    """Return the vehicle's step module with ``effects``, their values and their states at rest.

    The vehicle's own modules are handed in, because the vehicle does not know of the plant nor
    the plant of the vehicle.
    """
    added = compose(chosen(effects, "vehicle"), nominal_slots, {})
    rests = tuple(float(rest) for rest in added.rests)
    return _with_slots(nominal_step, added.slots), added.values, rests


def _with_slots(nominal_step: ModuleType, source: str) -> ModuleType:
    if not source:
        return nominal_step
    package = specialised_package(nominal_step.__package__ or "", {"slots.py": source})
    return importlib.import_module(f"{package.__name__}.step")
