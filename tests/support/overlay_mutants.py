"""The arbiter's sources broken on purpose, and whether its stories notice."""

from __future__ import annotations

import contextlib
import sys
from collections.abc import Iterator
from functools import cache
from pathlib import Path
from types import ModuleType, SimpleNamespace
from typing import Any

import numpy as np
from mutants import mutants
from overlay_stories import STORIES, Story
from second_arbiter import SecondArbiter

import pressure_control
from steering_core.parameters import ParameterError, ParameterSet, load_parameters

FOLDER = Path(pressure_control.__file__).parent
MODULES = (
    "limits",
    "overlay.lateral",
    "overlay.limits",
    "overlay.guests",
    "overlay.hands",
    "overlay.sources",
    "overlay.places",
    "overlay.split",
    "overlay.arbiter",
)
"""In the order in which they import each other."""
ROUNDING = 1e-9

SAME_VALUE = "at the edge both ways give the same value"
EQUIVALENT: dict[tuple[str, str], str] = {
    ("limits", "bounded + 2: edge of GtE"): SAME_VALUE,
    ("limits", "bounded + 4: edge of Gt"): SAME_VALUE,
    ("overlay.lateral", "lateral_gain + 7: edge of LtE"): SAME_VALUE,
    ("overlay.split", "overlaid + 7: edge of Gt"): SAME_VALUE,
    ("overlay.hands", "left_authority + 7: edge of Gt"): "the next lines set it for 0",
    ("overlay.arbiter", "_seat + 6: 0.0 to 1.0"): "it is set before it is read",
    ("overlay.arbiter", "_unheard + 2: 1.0 to 2.0"): "any negative number means: not yet",
}
"""(file, what is broken): why nobody can tell."""


@cache
def source(module: str) -> str:
    """Return the text of one file."""
    return (FOLDER / f"{module.replace('.', '/')}.py").read_text(encoding="utf-8")


@cache
def broken(module: str) -> list[tuple[str, str]]:
    """Return (what is broken, source) of all that can be broken in a file."""
    return list(mutants(source(module)))


@contextlib.contextmanager
def interpreted(replaced: str | None, text: str) -> Iterator[dict[str, ModuleType]]:
    """Give the modules by name as plain Python, the source of one of them replaced."""
    made: dict[str, ModuleType] = {}
    try:
        for name in MODULES:
            module = made[name] = ModuleType(f"broken_control.{name}")
            sys.modules[module.__name__] = module
            exec(_code(name, text if name == replaced else source(name)), module.__dict__)
        yield made
    finally:
        for module in made.values():
            sys.modules.pop(module.__name__, None)


@cache
def _code(name: str, text: str) -> Any:
    plain = text.replace("pressure_control.", "broken_control.")
    plain = plain.replace("from steering_core.compiled import kernel", "kernel = lambda f: f")
    return compile(plain, name, "exec")


def caught(modules: dict[str, ModuleType]) -> bool:
    """Return whether a story, or a split into pressures, comes out wrong or breaks off."""
    try:
        with np.errstate(all="ignore"):
            make = modules["overlay.arbiter"].OverlayArbiter
            right = (
                _split_holds(modules["overlay.split"].overlaid)
                and _refuses(make)
                and _refuses_guests(make)
                and _knows_no_trail(modules["overlay.lateral"].lateral_fields)
            )
            return not (right and all(holds(make, SecondArbiter, s) for s in STORIES))
    except Exception:
        return True


def holds(make: Any, second: Any, story: Story) -> bool:
    """Return whether the arbiter of ``make`` tells the story as ``second`` does."""
    arbiter = make(parameters(story), story.periods, story.delays)
    arbiter.par = arbiter.par.view(np.recarray) if make.__module__ != REAL else arbiter.par
    for row, expected in zip(_rows(arbiter, story), _expected(second, story), strict=True):
        if not np.all(np.abs(row - expected) <= ROUNDING * (1.0 + np.abs(expected))):
            return False
    return True


REAL = "pressure_control.overlay.arbiter"


def _rows(arbiter: Any, story: Story) -> Iterator[np.ndarray]:
    for tick, (wheel, bar, speed, wishes, messages) in enumerate(story.lines()):
        for name, torque, priority in messages:
            arbiter.hear_guest(name, tick, torque, priority)
        yield arbiter.step(tick, 0.0, wheel, bar, speed, *wishes)


_TOLD: dict[str, np.ndarray] = {}


def _expected(second: Any, story: Story) -> np.ndarray:
    if story.name not in _TOLD:
        arbiter = second(parameters(story), story.periods, story.delays)
        _TOLD[story.name] = np.array([row.copy() for row in _rows(arbiter, story)])
    return _TOLD[story.name]


_SETS: dict[str, ParameterSet] = {}


def parameters(story: Story) -> ParameterSet:
    """Return the parameter set of a story."""
    if story.name not in _SETS:
        _SETS[story.name] = load_parameters().with_values(story.values)
    return _SETS[story.name]


def _refuses(make: Any) -> bool:
    """Return whether an override that cannot be is refused."""
    for full in (0.5, 1.0):
        try:
            make(_override(full))
        except ParameterError as error:
            if "override_full must be greater" not in str(error):
                return False
        else:
            return False
    return True


def _refuses_guests(make: Any) -> bool:
    """Return whether bounds of a guest's period the wrong way round are refused, equal ones not."""
    make(_longest_guest_period(0.01))
    try:
        make(_longest_guest_period(0.009))
    except ParameterError as error:
        return "longest_guest_period must not be less" in str(error)
    return False


def _knows_no_trail(fields: Any) -> bool:
    """Return whether a car that tyres do not centre gets the greatest gain of all."""
    none = {"vehicle.pneumatic_trail": 0.0, "vehicle.mechanical_trail": 0.0}
    without = load_parameters().with_values(none)
    return bool(fields(without)["torque_gain"] == without["mechanics.gear_ratio"])


@cache
def _override(full: float) -> ParameterSet:
    return load_parameters().with_values({"overlay.override_full": full})


@cache
def _longest_guest_period(seconds: float) -> ParameterSet:
    return load_parameters().with_values({"overlay.longest_guest_period": seconds})


def _split_holds(overlaid: Any) -> bool:
    """Return whether an overlay is half taken from one chamber, as far as it goes."""
    p = SimpleNamespace(gear_ratio=32.0, piston_area=0.25)
    for torque in (-300.0, -80.0, -1.0, 0.0, 0.004, 1.0, 80.0, 300.0):
        change = torque * 32.0 / 0.25
        for reference in (0.0, 3e3, 5e5):
            for other in (0.0, 2e3, 5e5):
                half = 0.5 * abs(change)
                lowered = reference - min(half, reference)
                raised = reference + 2.0 * half - min(half, other)
                expected = raised if torque > 0.0 else lowered
                if abs(overlaid(p, reference, other, torque) - expected) > ROUNDING:
                    return False
    return bool(overlaid(p, 3e3, 2e3, np.nan) == 3e3)
