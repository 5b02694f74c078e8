"""What physics ties together in a record: pairs of signals that are the same but for a factor."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Literal

import numpy as np

from steering_core.parameters import ParameterSet
from steering_diagnosis.data.record import PERIOD_S, Record
from steering_diagnosis.steering.smoothing import bridged, low_pass

ALIKE = 0.85
"""Correlation from which two signals are the same but for a factor. Clean records and all effects
of the catalogue leave A, the loosest, at 0.9 where it is used at all: docs/diagnosis_model.md."""

SAME = 2.5
"""Factor within which two signals are right: gains and tolerances, friction beside a force."""

BAND_HZ, STEP = 10.0, 20
"""Low-pass of what is compared, and ticks between its samples: 20 ms."""

STEP_S = STEP * PERIOD_S

LOADED = 3.0
"""Force of the rack over its friction, standard deviations, from which forces can be compared."""

CHAMBERS = ("left_pressure", "right_pressure")
VALVES = ("closed_centre", "servo_valve")
ALL = ("open_centre", *VALVES)

Signals = Mapping[str, np.ndarray]


@dataclass(frozen=True)
class Relation:
    """``name`` should equal ``of`` but for friction, noise and an offset.

    needs: other channels. sized: whether the factor between the two is known, not their sign alone.
    shaped: whether they are alike in time as well; a small difference of large signals is not, as a
    ratio that is a little off moves it. level: what hardly moves is compared by its median. usable:
    whether a record shows the relation at all.
    """

    name: str
    needs: tuple[str, ...]
    of: Callable[[Signals, ParameterSet], np.ndarray]
    systems: tuple[str, ...] = ALL
    sized: bool = True
    shaped: bool = True
    level: bool = False
    usable: Callable[[Signals, ParameterSet], bool] = lambda s, p: True

    @property
    def members(self) -> tuple[str, ...]:
        """All channels of the relation."""
        return (self.name, *self.needs)

    def present(self, record: Record, signals: Signals) -> bool:
        """Return whether a record has the channels, of a gear that the relation holds for."""
        return record.valve_system in self.systems and set(self.members) <= set(signals)


@dataclass(frozen=True)
class Link:
    """How a relation stands in a record. factor: what ``name`` is too large by, a sign included.

    rest: what is not explained, standard deviation over that of ``name``.
    """

    relation: Relation
    state: Literal["right", "off", "unclear"]
    correlation: float
    factor: float
    rest: float

    @property
    def evidence(self) -> str:
        """Return the comparison in words."""
        if self.relation.level:
            return f"its median is {self.factor:.3g} times the data sheet's"
        others = " and ".join(self.relation.needs)
        if not self.relation.sized:
            return f"it goes against {others} (correlation {self.correlation:.2f})"
        return (
            f"against {others} it is {self.factor:.3g} times what it should be "
            f"(correlation {self.correlation:.2f})"
        )


def load_pressure(s: Signals) -> np.ndarray:
    """Return the load pressure [Pa], (n,)."""
    return s["right_pressure"] - s["left_pressure"]


def _assist(s: Signals, p: ParameterSet) -> np.ndarray:
    return p["mechanics.piston_area"] * load_pressure(s)


def _by_hand(s: Signals, p: ParameterSet) -> np.ndarray:
    return p["mechanics.gear_ratio"] * s["torsion_bar_torque"]


def _pushed(s: Signals, p: ParameterSet) -> np.ndarray:
    return _assist(s, p) + _by_hand(s, p)


def _loaded(s: Signals, p: ParameterSet) -> bool:
    """Either of both: the other one may be in a wrong unit."""
    size = max(np.std(s["rack_force"]), np.std(_pushed(s, p)))
    return bool(size > LOADED * p["mechanics.rack_friction"])


def _assisted(s: Signals, p: ParameterSet) -> bool:
    """Not assisted, the rack's motion drives oil through the valve, against the torque."""
    return bool(np.std(_assist(s, p)) > np.std(_by_hand(s, p)))


def _rate(name: str) -> Callable[[Signals, ParameterSet], np.ndarray]:
    return lambda s, p: np.gradient(s[name], STEP_S)


def _twist(s: Signals, p: ParameterSet) -> np.ndarray:
    twist = s["steering_wheel_angle"] - p["mechanics.gear_ratio"] * s["rack_position"]
    return p["mechanics.torsion_bar_stiffness"] * twist


def _level(system: str) -> Relation:
    return Relation(
        "supply_pressure",
        (),
        lambda s, p: np.array([p[f"{system}.supply_pressure"]]),
        (system,),
        shaped=False,
        level=True,
    )


KINEMATIC = Relation(
    "steering_wheel_angle",
    ("rack_position",),
    lambda s, p: p["mechanics.gear_ratio"] * s["rack_position"],
)
PUSHED = Relation(
    "rack_force",
    ("torsion_bar_torque", *CHAMBERS),
    _pushed,
    usable=_loaded,
)
RELATIONS = (
    KINEMATIC,
    Relation("steering_wheel_speed", ("steering_wheel_angle",), _rate("steering_wheel_angle")),
    Relation("rack_speed", ("rack_position",), _rate("rack_position")),
    Relation(
        "steering_wheel_speed",
        ("rack_speed",),
        lambda s, p: p["mechanics.gear_ratio"] * s["rack_speed"],
    ),
    PUSHED,
    Relation("torsion_bar_torque", ("steering_wheel_angle", "rack_position"), _twist, shaped=False),
    Relation(
        "torsion_bar_torque",
        CHAMBERS,
        lambda s, p: load_pressure(s),
        sized=False,
        shaped=False,
        usable=_assisted,
    ),
    Relation("driver_torque", ("torsion_bar_torque",), lambda s, p: s["torsion_bar_torque"]),
    Relation("rack_force", ("load_force",), lambda s, p: s["load_force"]),
    Relation(
        "supply_pressure",
        CHAMBERS,
        lambda s, p: s["left_pressure"] + s["right_pressure"],
        ("open_centre",),
    ),
    _level("closed_centre"),
    _level("servo_valve"),
    Relation(
        "left_pressure",
        ("left_reference_pressure",),
        lambda s, p: s["left_reference_pressure"],
        VALVES,
    ),
    Relation(
        "right_pressure",
        ("right_reference_pressure",),
        lambda s, p: s["right_reference_pressure"],
        VALVES,
    ),
)


def compared(record: Record, gone: set[str]) -> dict[str, np.ndarray]:
    """Return the channels as they are compared, low-passed, every 20 ms, (m,) each."""
    return {
        name: low_pass(bridged(values), BAND_HZ)[::STEP]
        for name, values in record.channels.items()
        if name not in gone and np.isfinite(values).any()
    }


def link(relation: Relation, s: Signals, p: ParameterSet) -> Link:
    """Return how a relation stands."""
    if relation.level:
        factor = float(np.median(s[relation.name]) / relation.of(s, p)[0])
        right = 1.0 / SAME < factor < SAME
        rest = abs(np.log(factor)) if right else 1.0
        return Link(relation, "right" if right else "off", 1.0, factor, rest)
    return judged(relation, s[relation.name], relation.of(s, p), relation.usable(s, p))


def judged(relation: Relation, values: np.ndarray, expected: np.ndarray, usable: bool) -> Link:
    """Return how two signals compare, (m,) each."""
    alike = correlation(values, expected)
    size = np.std(values)
    if not usable or abs(alike) < ALIKE:
        return Link(relation, "unclear", alike, np.nan, 1.0)
    factor = float(np.sign(alike) * size / np.std(expected))
    rest = float(np.std(values - expected) / size)
    right = factor > 0.0 and (not relation.sized or 1.0 / SAME < factor < SAME)
    if not relation.sized:
        rest = float(np.sqrt(1.0 - alike**2)) if right else 1.0
    return Link(relation, "right" if right else "off", alike, factor, rest)


def correlation(first: np.ndarray, second: np.ndarray) -> float:
    """Return the correlation of two signals, 0 where one does not move."""
    a, b = first - first.mean(), second - second.mean()
    size = float(np.sqrt((a @ a) * (b @ b)))
    return float(a @ b) / size if size > 0.0 else 0.0
