"""What looks wrong with a channel by itself: dead, clipped, stuck, jumping, coarse, a copy."""

from __future__ import annotations

from dataclasses import dataclass, field
from itertools import combinations

import numpy as np

from steering_diagnosis.data.channels import MEASURED
from steering_diagnosis.data.record import PERIOD_S, Record
from steering_diagnosis.steering.relations import (
    CHAMBERS,
    KINEMATIC,
    RELATIONS,
    STEP,
    Signals,
    judged,
    link,
)
from steering_diagnosis.steering.smoothing import bridged

CONSTANT_IS_FINE = ("supply_pressure",)
CLIPPED_RUN = 12
"""Equal samples in a row at a channel's extreme that a moving, noisy signal does not show."""

STUCK_RUN = 200
"""Equal samples in a row from which a channel may be stuck: a logger of 5 Hz is none."""
STUCK_MOVED = 0.2
"""Share of its range that what it should follow moves meanwhile: a bar twists less at a rack that
its friction holds."""
STUCK_JUMP = 3.0
"""Step out of a held value over all but one per cent of the other steps, and over a resolution."""
STUCK_LONG = 0.2
"""Share of a record from which a stuck channel is left out whole."""

ENCODERS = {"steering_wheel_angle": 0.25, "rack_position": 2e-3}
"""Channels that cannot jump, and steps of one tick that no gear makes [rad, m]: 250 rad/s, 2 m/s."""
JUMP = 20.0
"""Step of a jump over all but half a per cent of the other steps; clean records reach 3."""
TOGETHER, EVEN = 25, 0.1
"""Ticks that a jump may take between samples of a slow logger; how alike jumps of one wrap are."""
TURNS = {2.0 * np.pi: "a turn", np.pi: "half a turn"}

LEVELS = 48
"""Values that a channel takes, fewer of which are so coarse that their steps are no noise any more:
a 10-bit converter's over a twentieth of its range. Steps below a sensor's tolerance are none."""

COPY = 1e-6
"""What two channels differ by, over what they move, from which one is a copy of the other."""

VACUUM = 1.01325e5
ABOUT_ZERO = 0.25
"""Mean of a pressure over its standard deviation from which it swings about zero."""

NEVER_ZEROED = 0.15
"""Offset between wheel and rack [rad] that neither twist nor sensors explain: 0.03 on clean records
and 0.06 under all effects of the catalogue."""


@dataclass(frozen=True)
class Suspicion:
    """What is suspected. channels: those that it is about, left out of the replay.

    samples: of the record, (n,) bool, that must not be judged; None: all may.
    """

    text: str
    channels: tuple[str, ...]
    samples: np.ndarray | None = field(default=None, compare=False)


def _unit(name: str) -> str:
    return MEASURED[name].unit


def dead(record: Record) -> list[Suspicion]:
    """Find channels that do not move at all in a record where the wheel or the rack does."""
    alive = [n for n in MEASURED if n in record and _moves(record[n])]
    moving = {"steering_wheel_angle", "rack_position", "torsion_bar_torque"} & set(alive)
    fine = CONSTANT_IS_FINE if record.valve_system != "open_centre" else ()
    return [
        Suspicion(
            f"{name} is constant ({np.nanmedian(record[name]):.4g} {_unit(name)}) while "
            f"{sorted(moving)[0]} moves: a dead sensor or a wrong channel",
            (name,),
        )
        for name in MEASURED
        if moving and name in record and name not in alive and name not in fine
    ]


def _moves(values: np.ndarray) -> bool:
    known = values[np.isfinite(values)]
    return len(known) > 0 and float(np.ptp(known)) > 0.0


def clipped(record: Record, gone: set[str]) -> list[Suspicion]:
    """Find channels that stand still at their extremes after moving into them."""
    found = []
    for name in MEASURED:
        if name in record and name not in gone:
            where = clipping(record[name])
            if where.any():
                level = record[name][where][0]
                text = (
                    f"{name} seems to be clipped at {level:.4g} {_unit(name)}: "
                    f"{int(where.sum())} samples stand still there; they are not judged"
                )
                found.append(Suspicion(text, (), where))
    return found


def clipping(values: np.ndarray) -> np.ndarray:
    """Return the samples that stand still at the channel's extreme after moving into it, (n,)."""
    steps = np.abs(np.diff(values))
    moving = steps[np.isfinite(steps) & (steps > 0.0)]
    found = np.zeros(len(values), dtype=bool)
    if not len(moving):
        return found
    typical = 0.3 * float(np.median(moving))
    for level in (np.nanmax(values), np.nanmin(values)):
        for start, end in _runs(values == level):
            abrupt = start > 0 and steps[start - 1] > typical
            if end - start >= CLIPPED_RUN and abrupt:
                found[start:end] = True
    return found


def _runs(where: np.ndarray) -> list[tuple[int, int]]:
    """Return beginning and end (exclusive) of each run of true samples."""
    edges = np.diff(np.concatenate([[0], where.astype(np.int8), [0]]))
    return list(zip(np.flatnonzero(edges > 0), np.flatnonzero(edges < 0), strict=True))


def stuck(record: Record, signals: Signals) -> list[Suspicion]:
    """Find channels that hold a value while what they should follow moves on, or jump out of it."""
    found: dict[str, Suspicion] = {}
    for relation in RELATIONS:
        name, needs = relation.name, relation.needs
        if name not in MEASURED or name in found or not needs:
            continue
        if not relation.present(record, signals):
            continue
        if link(relation, signals, record.nominal).state != "unclear":
            expected = relation.of(signals, record.nominal)
            held = [
                (start, end)
                for start, end in _held(record[name])
                if np.ptp(expected[start // STEP : end // STEP + 1])
                > STUCK_MOVED * np.ptp(expected)
            ]
            if held:
                found[name] = _stuck(name, held, len(record), f"while {' and '.join(needs)} moves")
    for name in MEASURED:
        if name in signals and name not in found:
            held = [run for run in _held(record[name]) if _jumps_out(record[name], run[1])]
            if held:
                found[name] = _stuck(name, held, len(record), "and jumps out of it")
    return list(found.values())


def _held(values: np.ndarray) -> list[tuple[int, int]]:
    """Return first and last sample of each long run of equal samples, but for clipped ones."""
    free = ~clipping(values)
    runs = _runs(np.diff(values) == 0.0)
    return [(a, b) for a, b in runs if b - a >= STUCK_RUN and free[a : b + 1].all()]


def _jumps_out(values: np.ndarray, last: int) -> bool:
    if last + 1 >= len(values):
        return False
    steps = np.abs(np.diff(values))
    usual = max(float(np.nanquantile(steps, 0.99)), _resolution(values))
    return bool(steps[last] > STUCK_JUMP * usual)


def _resolution(values: np.ndarray) -> float:
    """Return the distance of the values that a coarse channel takes, 0 where it is not coarse."""
    levels = np.unique(values[np.isfinite(values)])
    return float(np.median(np.diff(levels))) if 1 < len(levels) < LEVELS else 0.0


def _stuck(name: str, held: list[tuple[int, int]], samples: int, why: str) -> Suspicion:
    where = np.zeros(samples, bool)
    for first, last in held:
        where[first : last + 1] = True
    whole = where.mean() > STUCK_LONG
    text = f"{name} is stuck for {where.sum() * PERIOD_S:.3g} s {why}"
    text += "" if whole else "; these samples are not judged"
    return Suspicion(text, (name,) if whole else (), where)


def jumping(record: Record) -> list[Suspicion]:
    """Find encoders that wrap, overflow or are zeroed on the way."""
    found = []
    for name, impossible in ENCODERS.items():
        if name in record:
            jumps = _jumps(bridged(record[name]), impossible)
            if len(jumps):
                found.append(Suspicion(f"{name} {_jump_text(jumps, _unit(name))}", (name,)))
    return found


def _jumps(values: np.ndarray, impossible: float) -> np.ndarray:
    """Return the sizes of the jumps that stay, signed; a spike comes back and is none."""
    step = np.diff(values)
    usual = float(np.quantile(np.abs(step), 0.995))
    least = min(JUMP * usual, impossible) if usual > 0.0 else impossible
    at = np.flatnonzero(np.abs(step) > least)
    at = np.setdiff1d(at, [last for _, last in _held(values)])
    if not len(at):
        return np.zeros(0)
    groups = np.split(at, np.flatnonzero(np.diff(at) > TOGETHER) + 1)
    sizes = np.array([step[g[0] : g[-1] + 1].sum() for g in groups])
    largest = np.array([np.abs(step[g]).max() for g in groups])
    return np.asarray(sizes[np.abs(sizes) > 0.5 * largest])


def _jump_text(jumps: np.ndarray, unit: str) -> str:
    size = float(np.median(np.abs(jumps)))
    places = f"at {len(jumps)} places" if len(jumps) > 1 else "once"
    if np.any(np.abs(np.abs(jumps) - size) > EVEN * size):
        return f"jumps {places}, by up to {np.abs(jumps).max():.3g} {unit}: a broken encoder"
    turn = next(
        (t for one, t in TURNS.items() if abs(size - one) < EVEN * one and unit == "rad"), ""
    )
    why = f"an angle wrapped at {turn}" if turn else "a counter that overflows, or is zeroed"
    return f"jumps {places}, by {size:.3g} {unit}: {why}"


def coarse(record: Record, gone: set[str]) -> list[Suspicion]:
    """Find moving channels that take so few values that their steps look like motion."""
    found = []
    for name in MEASURED:
        if name in record and name not in gone and name not in CONSTANT_IS_FINE:
            step = _resolution(record[name])
            if step > (MEASURED[name].offset or np.inf):
                levels = np.unique(record[name][np.isfinite(record[name])])
                text = (
                    f"{name} takes only {len(levels)} values, {step:.3g} {_unit(name)} apart: too "
                    "coarse to tell small effects"
                )
                found.append(Suspicion(text, ()))
    return found


def copies(record: Record, gone: set[str]) -> list[Suspicion]:
    """Find two measured channels that are one signal, but for factor and offset."""
    names = [n for n in MEASURED if n in record and n not in gone and _moves(record[n])]
    found = []
    for first, second in combinations(names, 2):
        a, b = bridged(record[first]), bridged(record[second])
        a, b = (a - a.mean()) / a.std(), (b - b.mean()) / b.std()
        if np.std(a - np.sign(a @ b) * b) < COPY:
            text = f"{first} and {second} are copies of one signal: one of them is a wrong channel"
            found.append(Suspicion(text, (first, second)))
    return found


def swinging(record: Record) -> list[Suspicion]:
    """Find chambers that both swing about zero, below a vacuum: their mean is not measured.

    One of them may be so by its sensor's offset.
    """
    if not set(CHAMBERS) <= set(record.channels):
        return []
    values = {name: bridged(record[name]) for name in CHAMBERS}
    if any(abs(v.mean()) > ABOUT_ZERO * v.std() for v in values.values()):
        return []
    if any(np.quantile(v, 0.01) > -VACUUM for v in values.values()):
        return []
    lowest = min(v.min() for v in values.values())
    text = (
        f"{' and '.join(CHAMBERS)} swing about zero, down to {lowest / 1e5:.3g} bar, below a "
        "vacuum: AC-coupled sensors"
    )
    return [Suspicion(text, CHAMBERS)]


def never_zeroed(record: Record, signals: Signals) -> list[Suspicion]:
    """Find an encoder that counts from anywhere: wheel and rack apart beyond any twist."""
    if not KINEMATIC.present(record, signals):
        return []
    values, expected = signals[KINEMATIC.name], KINEMATIC.of(signals, record.nominal)
    if judged(KINEMATIC, values, expected, usable=True).state != "right":
        return []
    # The bar's twist goes with its torque, and one of the gains may be a little off.
    columns = [np.ones(len(values)), expected]
    if "torsion_bar_torque" in signals:
        columns.append(
            signals["torsion_bar_torque"] / record.nominal["mechanics.torsion_bar_stiffness"]
        )
    apart = float(np.linalg.lstsq(np.column_stack(columns), values, rcond=None)[0][0])
    if abs(apart) < NEVER_ZEROED:
        return []
    text = (
        f"steering_wheel_angle and rack_position are {apart:.3g} rad at the wheel "
        f"({np.degrees(apart):.0f} deg) apart, which is no twist: one of them was never zeroed"
    )
    return [Suspicion(text, ("steering_wheel_angle", "rack_position"))]
