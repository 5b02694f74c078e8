"""What looks wrong with a channel by itself: dead, lost, clipped, stuck, jumping, a copy."""

from __future__ import annotations

from dataclasses import dataclass, field
from itertools import combinations

import numpy as np

from steering_diagnosis.data.channels import MEASURED
from steering_diagnosis.data.record import PERIOD_S, Record
from steering_diagnosis.data.units import FACTORS
from steering_diagnosis.steering.mistakes import ATMOSPHERE
from steering_diagnosis.steering.relations import (
    ANGLE,
    CHAMBERS,
    POSITION,
    RELATIONS,
    STEP,
    TORQUE,
    Signals,
    link,
)
from steering_diagnosis.steering.smoothing import bridged

CONSTANT_IS_FINE = ("supply_pressure",)
CLIPPED_RUN = 12
"""Equal samples in a row at a channel's extreme that a moving, noisy signal does not show."""
BEYOND = 3.0
"""What a clipped channel would have reached beyond its extreme, over its resolution there: 1.5
where a channel of few digits turns by itself."""

STUCK_RUN = 200
"""Equal samples in a row from which a channel may be stuck: a logger of 5 Hz is none."""
STUCK_MOVED = 0.2
"""Share of its range that what it should follow moves meanwhile: a bar twists less at a rack that
its friction holds."""
STUCK_JUMP = 10.0
"""Step out of a held value over all but one per cent of the other steps, and over a resolution."""
STUCK_LONG = 0.2
"""Share of a record from which a stuck channel is left out whole."""

ENCODERS = (ANGLE, POSITION)
"""Channels that cannot jump."""
JUMP, LEAP, NOISE = 20.0, 0.2, 12.0
"""Step of a jump over all but half a per cent of the other steps, clean records reach 3; or over
what the channel moves at all, of which a motion of 5 Hz makes 0.016 in a tick. Of a wheel that is
held that is noise alone: over the median step or the resolution twice what white noise reaches."""
TOGETHER, EVEN = 25, 0.1
"""Ticks that a jump may take between samples of a slow logger; how alike jumps of one wrap are."""
TURNS = {2.0 * np.pi: "a turn", np.pi: "half a turn"}

FEW = 0.5
"""Share of samples up to which one far value stands for a lost measurement."""

COPY = 1e-6
"""What two channels differ by, over what they move, from which one is a copy of the other."""

ABOUT_ZERO = 0.25
"""Mean of a pressure over its standard deviation from which it swings about zero."""


@dataclass(frozen=True)
class Suspicion:
    """What is suspected. channels: those that it is about, left out of the replay.

    samples: of the record, (n,) bool, that must not be judged, because of the channel ``about``.
    lost: whether it has no value there at all.
    """

    text: str
    channels: tuple[str, ...]
    samples: np.ndarray | None = field(default=None, compare=False)
    about: str = ""
    lost: bool = False


def _shown(record: Record, name: str, value: float) -> str:
    """Return a value in the unit that its channel was read in."""
    si = MEASURED[name].unit
    unit = record.units.get(name, si)
    return f"{value / FACTORS[si].get(unit, 1.0):.6g} {unit}"


def dead(record: Record) -> list[Suspicion]:
    """Find channels that do not move at all in a record where the wheel or the rack does."""
    alive = [n for n in MEASURED if n in record and _moves(record[n])]
    moving = [n for n in (ANGLE, POSITION, TORQUE) if n in alive]
    fine = [
        n
        for n in CONSTANT_IS_FINE
        if n in record and record.valve_system != "open_centre" and np.nanmax(record[n]) != 0.0
    ]
    return [
        Suspicion(
            f"{name} is constant ({_shown(record, name, float(np.nanmedian(record[name])))}) while "
            f"{moving[0]} moves: a dead sensor or a wrong channel; check its `from`",
            (name,),
        )
        for name in MEASURED
        if moving and name in record and name not in alive and name not in fine
    ]


def _moves(values: np.ndarray) -> bool:
    known = values[np.isfinite(values)]
    return len(known) > 0 and float(np.ptp(known)) > 0.0


def lost(record: Record) -> list[Suspicion]:
    """Find a number that stands for no measurement, as -999: far from everything else."""
    found = []
    for name in MEASURED:
        values = record.channels.get(name, np.zeros(0))
        levels = np.unique(values[np.isfinite(values)])
        if len(levels) < 3:
            continue
        for level, rest in ((levels[0], levels[1:]), (levels[-1], levels[:-1])):
            where = values == level
            gap = min(abs(level - rest[0]), abs(level - rest[-1]))
            usual = max(np.ptp(rest), np.abs(rest).max())
            if gap > usual and where.sum() > 1 and where.mean() < FEW:
                text = (
                    f"{name} is {_shown(record, name, level)} in {where.sum()} samples, nowhere "
                    "near it: no measurement; `missing` names such a number"
                )
                found.append(Suspicion(text, (), where, name, lost=True))
    return found


def clipped(record: Record, gone: set[str]) -> list[Suspicion]:
    """Find channels that stand still at their extremes after moving into them."""
    found = []
    for name in MEASURED:
        if name in record and name not in gone:
            where = clipping(record[name])
            if where.any():
                text = (
                    f"{name} seems to be clipped at "
                    f"{_shown(record, name, float(record[name][where][0]))}: {int(where.sum())} "
                    "samples stand still there; they are not judged; measure with a wider range"
                )
                found.append(Suspicion(text, (), where, name))
    return found


def clipping(values: np.ndarray) -> np.ndarray:
    """Return the samples that stand still at the channel's extreme after moving into it, (n,).

    A parabola that enters with the slope there would have gone beyond it. One that turns within
    the resolution of the channel is none: few digits hold their extremes as well. Nor is it where
    the channel rests, as a supply of few digits does at the pressure that it is regulated to.
    """
    found = np.zeros(len(values), dtype=bool)
    known = values[np.isfinite(values)]
    levels = np.unique(known)
    if len(levels) < 2:
        return found
    rest = np.median(known)
    for level, next_one in ((levels[-1], levels[-2]), (levels[0], levels[1])):
        if level == rest:
            continue
        for start, end in _runs(values == level):
            run = end - start
            before = values[max(start - max(run // 2, 1), 0) : start]
            if run < CLIPPED_RUN or not len(before):
                continue
            slope = float(np.nanmax(np.abs(level - before))) / len(before)
            if slope * run / 4.0 > BEYOND * abs(level - next_one):
                found[start:end] = True
    return found


def _runs(where: np.ndarray) -> list[tuple[int, int]]:
    """Return beginning and end (exclusive) of each run of true samples."""
    edges = np.diff(np.concatenate([[0], where.astype(np.int8), [0]]))
    return list(zip(np.flatnonzero(edges > 0), np.flatnonzero(edges < 0), strict=True))


def stuck(record: Record, signals: Signals) -> list[Suspicion]:
    """Find channels that hold a value while what they should follow moves on, or jump out of it."""
    held = {n: _held(record[n]) for n in MEASURED if n in signals}
    found: dict[str, Suspicion] = {}
    for relation in RELATIONS:
        name = relation.name
        if not held.get(name) or name in found or not relation.present(record, signals):
            continue
        if link(relation, signals, record.nominal).state != "unclear":
            expected = relation.of(signals, record.nominal)
            least = STUCK_MOVED * np.ptp(expected)
            runs = [
                (start, end)
                for start, end in held[name]
                if len(while_held := expected[start // STEP : end // STEP + 1])
                and np.ptp(while_held) > least
            ]
            if runs:
                why = f"while {' and '.join(relation.needs)} moves"
                found[name] = _stuck(name, runs, len(record), why)
    for name, runs in held.items():
        jumped = [run for run in runs if _jumps_out(record[name], run[1])]
        if jumped and name not in found:
            found[name] = _stuck(name, jumped, len(record), "and jumps out of it")
    return list(found.values())


def _held(values: np.ndarray) -> list[tuple[int, int]]:
    """Return first and last sample of each long run of equal samples, but for clipped ones."""
    free = ~clipping(values)
    runs = _runs(np.diff(values) == 0.0)
    return [(a, b) for a, b in runs if b - a >= STUCK_RUN and free[a : b + 1].all()]


def _jumps_out(values: np.ndarray, last: int) -> bool:
    steps = np.abs(np.diff(values))
    if last >= len(steps) or not np.isfinite(steps[last]):
        return False
    moving = steps[np.isfinite(steps) & (steps > 0.0)]
    return bool(steps[last] > STUCK_JUMP * max(np.quantile(moving, 0.99), moving.min()))


def _stuck(name: str, held: list[tuple[int, int]], samples: int, why: str) -> Suspicion:
    where = np.zeros(samples, bool)
    for first, last in held:
        where[first : last + 1] = True
    whole = where.mean() > STUCK_LONG
    text = f"{name} is stuck for {where.sum() * PERIOD_S:.3g} s {why}"
    text += "" if whole else "; these samples are not judged"
    return Suspicion(f"{text}; check its cable and bus", (name,) if whole else (), where, name)


def jumping(record: Record) -> list[Suspicion]:
    """Find encoders that wrap, overflow or are zeroed on the way."""
    found = []
    for name in ENCODERS:
        if name in record:
            jumps = _jumps(bridged(record[name]))
            if len(jumps):
                found.append(Suspicion(f"{name} {_jump_text(record, name, jumps)}", (name,)))
    return found


def _jumps(values: np.ndarray) -> np.ndarray:
    """Return the sizes of the jumps that stay, signed; a spike comes back and is none."""
    step = np.diff(values)
    size = np.abs(step)
    usual = float(np.quantile(size, 0.995))
    noise = max(float(np.median(size)), float(np.min(size, where=size > 0.0, initial=np.inf)))
    impossible = max(LEAP * float(np.ptp(values)), NOISE * noise)
    least = min(JUMP * usual, impossible) if usual > 0.0 else impossible
    at = np.flatnonzero(size > least)
    at = np.setdiff1d(at, [last for _, last in _held(values)])
    if not len(at):
        return np.zeros(0)
    groups = np.split(at, np.flatnonzero(np.diff(at) > TOGETHER) + 1)
    sizes = np.array([step[g[0] : g[-1] + 1].sum() for g in groups])
    largest = np.array([np.abs(step[g]).max() for g in groups])
    return np.asarray(sizes[np.abs(sizes) > 0.5 * largest])


def _jump_text(record: Record, name: str, jumps: np.ndarray) -> str:
    size = float(np.median(np.abs(jumps)))
    places = f"at {len(jumps)} places" if len(jumps) > 1 else "once"
    if np.any(np.abs(np.abs(jumps) - size) > EVEN * size):
        largest = _shown(record, name, float(np.abs(jumps).max()))
        return f"jumps {places}, by up to {largest}: a broken encoder"
    angle = MEASURED[name].unit == "rad"
    turn = next((t for one, t in TURNS.items() if abs(size - one) < EVEN * one and angle), "")
    why = f"an angle wrapped at {turn}" if turn else "a counter that overflows, or is zeroed"
    return f"jumps {places}, by {_shown(record, name, size)}: {why}; unwrap it before it is mapped"


def copies(record: Record, gone: set[str]) -> list[Suspicion]:
    """Find two measured channels that are one signal, but for factor and offset."""
    names = [n for n in MEASURED if n in record and n not in gone and _moves(record[n])]
    scaled = {n: _scaled(bridged(record[n])) for n in names}
    found = []
    for first, second in combinations(names, 2):
        a, b = scaled[first], scaled[second]
        if np.std(a - np.sign(a @ b) * b) < COPY:
            text = (
                f"{first} and {second} are copies of one signal: one of them is a wrong channel; "
                "check their `from`"
            )
            found.append(Suspicion(text, (first, second)))
    return found


def _scaled(values: np.ndarray) -> np.ndarray:
    return np.asarray((values - values.mean()) / values.std())


def swinging(record: Record) -> list[Suspicion]:
    """Find chambers that both swing about zero, below a vacuum: their mean is not measured.

    One of them may be so by its sensor's offset.
    """
    if not set(CHAMBERS) <= set(record.channels):
        return []
    values = {name: bridged(record[name]) for name in CHAMBERS}
    if any(abs(v.mean()) > ABOUT_ZERO * v.std() for v in values.values()):
        return []
    if any(np.quantile(v, 0.01) > -ATMOSPHERE for v in values.values()):
        return []
    lowest = min(v.min() for v in values.values())
    text = (
        f"{' and '.join(CHAMBERS)} swing about zero, down to {lowest / 1e5:.3g} bar, below a "
        "vacuum: AC-coupled sensors; measure them with DC-coupled amplifiers"
    )
    return [Suspicion(text, CHAMBERS)]
