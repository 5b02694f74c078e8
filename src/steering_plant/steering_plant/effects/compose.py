"""From chosen effects to the source of a ``slots`` module, their parameters and their states."""

from __future__ import annotations

import inspect
from collections.abc import Mapping
from dataclasses import dataclass
from types import ModuleType
from typing import Any

import numpy as np

from steering_core.naming import unknown
from steering_core.parameters import ParameterSet
from steering_plant.effects import EFFECTS
from steering_plant.effects.base import Effect, Kernel, arguments

STATE_SLOTS = {"effect_rates": "dy", "sampled_states": "y", "next_states": "y"}
"""Slots that move the effects' states, with the array that takes the result."""


@dataclass(frozen=True)
class Composition:
    """What chosen effects add to one model.

    slots: source of the slots module, empty where no effect acts in a slot. values: parameters of
    the effects that act in slots, shape (n,), float64. rests, tolerances: of the added states, in
    order. positions: of (effect, parameter) in ``values``. states: of (effect, state) in the state
    vector, from its end. chosen: all parameters of the effects of this model.
    """

    slots: str
    values: np.ndarray
    rests: tuple[float | str, ...]
    tolerances: tuple[float, ...]
    positions: Mapping[tuple[str, str], int]
    states: Mapping[tuple[str, str], int]
    chosen: Mapping[str, Mapping[str, float]]

    def changed(self, parameters: ParameterSet, valve_system: str) -> ParameterSet:
        """Return the data sheet as the effects that act in ``valve_system`` change it."""
        changes: dict[str, float] = {}
        for name, values in self.chosen.items():
            for parameter in EFFECTS[name].acting(valve_system).keys() & EFFECTS[name].sets.keys():
                change = EFFECTS[name].sets[parameter]
                for full in change.names:
                    value = changes.get(full, parameters[full])
                    changes[full] = change.applied(value, values[parameter])
        return parameters.with_values(changes)


def chosen(effects: Mapping[str, Mapping[str, Any]], acts_in: str) -> dict[str, dict[str, float]]:
    """Return the effects that act in one model, in the registry's order, with checked values.

    effects: name to parameters; parameters not given are typical. ValueError for unknown names.
    """
    for name in effects:
        if name not in EFFECTS:
            raise ValueError(unknown("effect", name, EFFECTS))
    return {
        name: effect.values(effects[name])
        for name, effect in EFFECTS.items()
        if name in effects and effect.acts_in == acts_in
    }


def compose(
    effects: Mapping[str, Mapping[str, float]], nominal: ModuleType, signals: Mapping[str, str]
) -> Composition:
    """Return what ``effects`` (of one model, checked: see ``chosen``) add to it.

    nominal: the model's slots module. signals: names that an effect's kernels may ask for beside
    the slot's own arguments, with the expressions that stand for them (``y[2]``).
    """
    active = [EFFECTS[name] for name in effects if EFFECTS[name].slots]
    parameters = [(effect.name, name) for effect in active for name in effect.parameters]
    states = [(effect.name, name) for effect in active for name in effect.states]
    added = [EFFECTS[effect].states[name] for effect, name in states]
    positions = {key: position for position, key in enumerate(parameters)}
    places = {key: position - len(states) for position, key in enumerate(states)}
    own: dict[str, dict[str, str]] = {effect.name: {} for effect in active}
    for (effect, name), position in positions.items():
        own[effect][name] = f"e[{position}]"
    for (effect, name), position in places.items():
        own[effect][name] = f"y[{position}]"
    return Composition(
        slots=_source(active, nominal, signals, own) if active else "",
        values=np.array([effects[effect][name] for effect, name in parameters], dtype=np.float64),
        rests=tuple(state.rest for state in added),
        tolerances=tuple(state.tolerance for state in added),
        positions=positions,
        states=places,
        chosen=effects,
    )


def _source(
    active: list[Effect],
    nominal: ModuleType,
    signals: Mapping[str, str],
    own: Mapping[str, Mapping[str, str]],
) -> str:
    slots = {
        name: arguments(made)
        for name, made in vars(nominal).items()
        if hasattr(made, "py_func") and made.__module__ == nominal.__name__
    }
    for effect in active:
        for slot in effect.slots:
            if slot not in slots:
                raise ValueError(f"effect {effect.name}: {unknown('slot', slot, slots)}")
    modules = sorted({inspect.getmodule(k).__name__ for e in active for k in _kernels(e)})  # type: ignore[union-attr]
    imports = "\n".join(f"import {module}" for module in modules)
    bodies = [_slot(name, taken, active, signals, own) for name, taken in slots.items()]
    head = f'"""Slots of {", ".join(e.name for e in active)}; generated."""'
    return "\n\n\n".join(
        [f"{head}\n\n{imports}\nfrom steering_core.compiled import kernel", *bodies, ""]
    )


def _kernels(effect: Effect) -> list[Kernel]:
    return [*effect.slots.values(), *(state.rate for state in effect.states.values())]


def _slot(
    name: str,
    taken: list[str],
    active: list[Effect],
    signals: Mapping[str, str],
    own: Mapping[str, Mapping[str, str]],
) -> str:
    """Return the source of one slot: the effects' calls in turn on its value, or on the states."""
    known = _known(taken, signals)

    def call(effect: Effect, made: Kernel) -> str:
        return _call(effect, made, known | dict(own[effect.name]))

    if name in STATE_SLOTS:
        lines = [
            f"    {STATE_SLOTS[name]}{own[effect.name][state].removeprefix('y')} = "
            f"{call(effect, made.rate)}"
            for effect in active
            for state, made in effect.states.items()
            if made.sampled == (name == "sampled_states")
        ]
        if name == "effect_rates":
            lines += [
                f"    dy{own[effect.name][state].removeprefix('y')} = 0.0"
                for effect in active
                for state, made in effect.states.items()
                if made.sampled
            ]
        lines = lines or ["    pass"]
    else:
        changes = [e for e in active if name in e.slots]
        lines = [f"    value = {call(effect, effect.slots[name])}" for effect in changes]
        lines.append("    return value")
    return "\n".join([_head(name, taken), *lines])


def _known(taken: list[str], signals: Mapping[str, str]) -> dict[str, str]:
    """Return what a slot with the arguments ``taken`` can offer to an effect, by name."""
    within_reach = {n: text for n, text in signals.items() if text.split("[")[0] in taken}
    return within_reach | {argument: argument for argument in taken}


def _head(name: str, taken: list[str]) -> str:
    return f"@kernel\ndef {name}({', '.join(taken)}):"


def _call(effect: Effect, made: Kernel, known: Mapping[str, str]) -> str:
    for argument in arguments(made):
        if argument not in known:
            raise ValueError(f"effect {effect.name}: {unknown('argument', argument, known)}")
    given = ", ".join(known[argument] for argument in arguments(made))
    function = getattr(made, "py_func", made)
    return f"{function.__module__}.{function.__qualname__}({given})"
