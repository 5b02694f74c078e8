"""What physics ties together in a record: signals that are the same but for friction and noise."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Literal

import numpy as np

from steering_core.parameters import ParameterSet
from steering_diagnosis.data.record import PERIOD_S, Record
from steering_diagnosis.steering.smoothing import bridged, low_pass

ALIKE = 0.85
"""Correlation from which two signals are the same but for a factor."""

CLOSE = 0.99
"""Correlation from which a delay is too short beside the motion to be told."""

BAND_HZ, STEP = 10.0, 20
"""Low-pass of what is compared, and ticks between its samples."""

STEP_S = STEP * PERIOD_S

TRIMMED = 0.05
"""Share of the samples that fit worst and do not count: a dropout is no unit."""

STILL = 1e-18
"""Energy of a signal's motion over its own from which it moves: its rounding is 1e-16, squared."""

LOADED = 3.0
"""Force of the rack over its friction, standard deviations, from which forces can be compared."""

CHAMBERS = ("left_pressure", "right_pressure")
VALVES = ("closed_centre", "servo_valve")
ALL = ("open_centre", *VALVES)

Signals = Mapping[str, np.ndarray]
Expected = Callable[[Signals, ParameterSet], np.ndarray]


@dataclass(frozen=True)
class Relation:
    """``name`` should equal ``of`` but for friction, noise and an offset.

    needs: other channels. beside: further ones, in any unit and of any sign. within: factor by
    which the two may differ; None: only the sign is known. apart: offset [unit of name] that they
    may have; None: any. timed: whether a delay shows, as it does not where a valve or a friction
    stands between the two. level: what hardly moves is compared by its median. usable: whether a
    record shows the relation at all.
    """

    name: str
    needs: tuple[str, ...]
    of: Expected
    beside: tuple[str, ...] = ()
    systems: tuple[str, ...] = ALL
    within: float | None = 2.5
    apart: float | None = None
    timed: bool = True
    level: bool = False
    usable: Callable[[Signals, ParameterSet], bool] = lambda s, p: True

    @property
    def members(self) -> tuple[str, ...]:
        """All channels of the relation."""
        return (self.name, *self.needs)

    def present(self, record: Record, signals: Signals) -> bool:
        """Return whether a record has the channels, of a gear that the relation holds for."""
        return record.valve_system in self.systems and {*self.members, *self.beside} <= set(signals)


@dataclass(frozen=True)
class Link:
    """How a relation stands in a record. factor: what ``name`` is too large by, a sign included.

    usable: whether the record shows it. offset: [unit of name] that remains. rest: what is not
    explained, standard deviation over that of ``name``.
    """

    relation: Relation
    state: Literal["right", "off", "unclear"]
    usable: bool
    correlation: float
    factor: float
    offset: float
    rest: float

    @property
    def open(self) -> bool:
        """Whether there is something to explain: it is off, or not as alike in time as it might."""
        reshaped = self.relation.timed and self.usable and abs(self.correlation) < CLOSE
        return self.state == "off" or reshaped

    @property
    def apart(self) -> bool:
        """Whether it is the offset alone that is off."""
        limit = self.relation.apart
        return limit is not None and abs(self.offset) > limit and self.factor > 0.0

    @property
    def evidence(self) -> str:
        """Return the comparison in words."""
        if self.relation.level:
            return f"its median is {self.factor:.3g} times the data sheet's"
        others = " and ".join(self.relation.needs)
        if self.relation.within is None:
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


def _rate(name: str) -> Expected:
    return lambda s, p: np.gradient(s[name], STEP_S)


def _times(factor: str, name: str) -> Expected:
    return lambda s, p: p[factor] * s[name]


def _same(name: str) -> Expected:
    return lambda s, p: s[name]


def _level(name: str) -> Expected:
    return lambda s, p: np.array([p[name]])


def _fitted(s: Signals, p: ParameterSet) -> tuple[np.ndarray, np.ndarray]:
    """Return what the wheel's angle [rad] is made of, (n, 3), and each part's factor, (3,).

    The parts are the rack, its rate (one of the sensors may be late by so many seconds) and the
    bar's torque, which is of standard deviation one: any unit and sign will do.
    """
    rack, torque = p["mechanics.gear_ratio"] * s["rack_position"], s["torsion_bar_torque"]
    parts = np.column_stack(
        [rack, np.gradient(rack, STEP_S), torque / max(float(np.std(torque)), 1e-12)]
    )
    columns = np.column_stack([parts, np.ones(len(rack))])
    normal, right = columns.T @ columns, columns.T @ s["steering_wheel_angle"]
    found = np.linalg.lstsq(normal, right, rcond=None)[0]
    return parts, found[:3]


def _beside_twist(s: Signals, p: ParameterSet) -> np.ndarray:
    parts, factors = _fitted(s, p)
    return np.asarray(parts[:, 0] + factors[2] * parts[:, 2])


def _twists_little(s: Signals, p: ParameterSet) -> bool:
    """A torque that has to explain most of an angle explains something else."""
    _, factors = _fitted(s, p)
    return bool(abs(factors[2]) < TWIST * np.std(s["steering_wheel_angle"]))


TWIST = 0.4
"""Largest twist over the wheel's angle; 0.25 on dry asphalt."""


def _twist(s: Signals, p: ParameterSet) -> np.ndarray:
    """Return the bar's torque [N m] by its twist, a small difference of two large angles.

    A ratio that is a little off, or a sensor's delay, moves it more than the torque does; so both
    are fitted.
    """
    parts, factors = _fitted(s, p)
    near = abs(factors[0] - 1.0) < RATIO and abs(factors[1]) < DELAY_S
    ratio, late = factors[:2] if near else (1.0, 0.0)
    twist = s["steering_wheel_angle"] - ratio * parts[:, 0] - late * parts[:, 1]
    return np.asarray(p["mechanics.torsion_bar_stiffness"] * twist)


RATIO, DELAY_S = 0.01, 0.06
"""How much the pinion's ratio and both sensors' gains may be off together; and how late one of them
may be beside the other."""

ANGLE, POSITION = "steering_wheel_angle", "rack_position"
TORQUE, FORCE = "torsion_bar_torque", "rack_force"
RELATIONS = (
    Relation(
        ANGLE,
        (POSITION,),
        _times("mechanics.gear_ratio", POSITION),
        within=1.7,
    ),
    Relation(
        ANGLE,
        (POSITION,),
        _beside_twist,
        (TORQUE,),
        within=1.15,
        apart=0.15,
        usable=_twists_little,
    ),
    Relation("steering_wheel_speed", (ANGLE,), _rate(ANGLE), within=1.2),
    Relation("rack_speed", (POSITION,), _rate(POSITION), within=1.2),
    Relation(
        "steering_wheel_speed",
        ("rack_speed",),
        _times("mechanics.gear_ratio", "rack_speed"),
        within=1.8,
    ),
    Relation(FORCE, (TORQUE, *CHAMBERS), _pushed, usable=_loaded),
    Relation(TORQUE, (ANGLE, POSITION), _twist),
    Relation(
        TORQUE,
        CHAMBERS,
        lambda s, p: load_pressure(s),
        within=None,
        timed=False,
        usable=_assisted,
    ),
    Relation("driver_torque", (TORQUE,), _same(TORQUE), timed=False),
    Relation(FORCE, ("load_force",), _same("load_force")),
    Relation(
        "supply_pressure",
        CHAMBERS,
        lambda s, p: s["left_pressure"] + s["right_pressure"],
        systems=("open_centre",),
    ),
    *(
        Relation(
            "supply_pressure",
            (),
            _level(f"{system}.supply_pressure"),
            systems=(system,),
            timed=False,
            level=True,
        )
        for system in VALVES
    ),
    *(
        Relation(
            f"{side}_pressure",
            (f"{side}_reference_pressure",),
            _same(f"{side}_reference_pressure"),
            systems=VALVES,
            apart=7e4,
        )
        for side in ("left", "right")
    ),
)


def compared(record: Record, gone: set[str]) -> dict[str, np.ndarray]:
    """Return the channels as they are compared, low-passed, every 20 ms, (m,) each."""
    return {
        name: low_pass(bridged(values), BAND_HZ)[::STEP]
        for name, values in record.channels.items()
        if name not in gone and np.isfinite(values).any()
    }


def informative(signals: Signals, samples: np.ndarray) -> dict[str, np.ndarray]:
    """Return compared signals without those near ``samples`` of the record, (n,) bool.

    As they are where more than half of them would be left out.
    """
    reach = np.convolve(samples, np.ones(2 * STEP + 1), "same") > 0.5
    kept = ~reach[::STEP]
    return {n: x[kept] if kept.mean() > 0.5 else x for n, x in signals.items()}


def link(relation: Relation, s: Signals, p: ParameterSet) -> Link:
    """Return how a relation stands."""
    values, expected = s[relation.name], relation.of(s, p)
    if relation.level:
        factor, within = float(np.median(values) / expected[0]), relation.within or np.inf
        right = 1.0 / within < factor < within
        rest = abs(np.log(factor)) if right else 1.0
        return Link(relation, "right" if right else "off", True, 1.0, factor, 0.0, float(rest))
    usable = relation.usable(s, p)
    return judged(relation, values, expected, usable)


def judged(relation: Relation, values: np.ndarray, expected: np.ndarray, usable: bool) -> Link:
    """Return how two signals compare, (m,) each."""
    alike = correlation(values, expected)
    if not usable or abs(alike) < ALIKE:
        return Link(relation, "unclear", usable, alike, np.nan, np.nan, 1.0)
    values, expected = _trimmed(values, expected, alike)
    size, other = float(np.std(values)), float(np.std(expected))
    factor = float(np.sign(alike)) * size / other if other > 0.0 else np.nan
    offset = float(np.mean(values) - factor * np.mean(expected))
    rest = float(np.std(values - expected) / size) if size > 0.0 else 1.0
    if relation.within is None:
        right = factor > 0.0
    else:
        right = 1.0 / relation.within < factor < relation.within
        right = right and (relation.apart is None or abs(offset) < relation.apart)
    return Link(relation, "right" if right else "off", usable, alike, factor, offset, rest)


def _trimmed(
    values: np.ndarray, expected: np.ndarray, alike: float
) -> tuple[np.ndarray, np.ndarray]:
    """Return two signals without the samples that fit worst."""
    first = (values - values.mean()) / values.std()
    second = np.sign(alike) * (expected - expected.mean()) / expected.std()
    apart = np.abs(first - second)
    last = int((1.0 - TRIMMED) * (len(apart) - 1))
    kept = apart <= np.partition(apart, last)[last]
    return values[kept], expected[kept]


def correlation(first: np.ndarray, second: np.ndarray) -> float:
    """Return the correlation of two signals, 0 where one does not move beyond its rounding."""
    a, b = first - first.mean(), second - second.mean()
    sizes = float(a @ a), float(b @ b)
    rounding = STILL * float(first @ first), STILL * float(second @ second)
    if sizes[0] <= rounding[0] or sizes[1] <= rounding[1]:
        return 0.0
    return float(a @ b) / float(np.sqrt(sizes[0] * sizes[1]))
