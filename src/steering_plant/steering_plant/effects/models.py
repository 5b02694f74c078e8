"""The plant's and the vehicle's models with effects: one that holds them all serves every choice.

The effects that are not chosen are neutral, which is the nominal model to the bit. So a choice of
effects costs no compilation; what it costs a run is in ``steer bench effects_speed``.
"""

from __future__ import annotations

import importlib
from collections.abc import Iterable, Mapping
from types import MappingProxyType, ModuleType
from typing import Any

import numpy as np

from steering_core.specialise import specialised_package
from steering_plant.effects import EFFECTS
from steering_plant.effects.compose import Composition, chosen, compose
from steering_plant.model import slots, states, step

NO_EFFECTS: Mapping[str, Mapping[str, Any]] = MappingProxyType({})

STATE_NAMES = {
    "open_centre": states.OPEN_CENTRE_NAMES,
    "closed_centre": states.CLOSED_CENTRE_NAMES,
    "servo_valve": states.SERVO_VALVE_NAMES,
}


def plant_signals(valve_system: str) -> dict[str, str]:
    """Return the states, held inputs and flows that an effect in the plant may ask for, by name."""
    return (
        {name: f"y[{i}]" for i, name in enumerate(STATE_NAMES[valve_system])}
        | {name: f"u[{i}]" for i, name in enumerate(states.INPUT_NAMES)}
        | {name: f"flows[{i}]" for i, name in enumerate(states.FLOW_NAMES)}
    )


def need_slots(effects: Iterable[str]) -> bool:
    """Return whether one of ``effects`` acts in a slot, so that both models must hold them all.

    Both, of the plant and of the vehicle: the direct loop is compiled for the pair of them.
    """
    return any(EFFECTS[name].slots for name in effects if name in EFFECTS)


def plant_model(
    effects: Mapping[str, Mapping[str, Any]], valve_system: str
) -> tuple[ModuleType, Composition]:
    """Return the plant's step module for ``effects``, and what they add to data and state.

    The nominal module where none of them needs a slot, else the one that holds all effects of
    ``valve_system``. Effects that do not act in ``valve_system`` are left out.
    """
    active = {
        name: values
        for name, values in chosen(effects, "plant").items()
        if valve_system in EFFECTS[name].valve_systems
    }
    if need_slots(effects):
        active = all_effects(valve_system, active)
    added = compose(active, slots, plant_signals(valve_system))
    return _with_slots(step, added.slots), added


def all_effects(
    valve_system: str, given: Mapping[str, Mapping[str, float]] = NO_EFFECTS
) -> dict[str, dict[str, float]]:
    """Return every effect of the plant: those ``given`` with their values, the others neutral.

    ``plant_model(all_effects(valve_system), valve_system)`` says where in the vectors of the model
    that holds them all each parameter and state is (``Composition.positions`` and ``states``).
    """
    return {
        name: neutral | dict(given.get(name, {}))
        for name, neutral in _neutral("plant").items()
        if valve_system in EFFECTS[name].valve_systems
    }


def vehicle_model(
    effects: Mapping[str, Mapping[str, Any]], nominal_slots: ModuleType, nominal_step: ModuleType
) -> tuple[ModuleType, np.ndarray, tuple[float, ...]]:
    """Return the vehicle's step module for ``effects``, their values and their states at rest.

    The vehicle's own modules are handed in, because the vehicle does not know of the plant nor
    the plant of the vehicle.
    """
    active = chosen(effects, "vehicle")
    if need_slots(effects):
        active = _neutral("vehicle") | active
    added = compose(active, nominal_slots, {})
    rests = tuple(float(rest) for rest in added.rests)
    return _with_slots(nominal_step, added.slots), added.values, rests


def _neutral(acts_in: str) -> dict[str, dict[str, float]]:
    """Return every effect of one model with its neutral values, in the registry's order."""
    return {name: e.neutral() for name, e in EFFECTS.items() if e.acts_in == acts_in}


def _with_slots(nominal_step: ModuleType, source: str) -> ModuleType:
    if not source:
        return nominal_step
    package = specialised_package(nominal_step.__package__ or "", {"slots.py": source})
    return importlib.import_module(f"{package.__name__}.step")
