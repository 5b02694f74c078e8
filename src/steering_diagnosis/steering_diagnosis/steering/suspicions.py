"""What looks wrong with a record itself: signs, units, swapped, clipped or dead channels.

Channels that physics ties together are compared in pairs. A channel is suspected where every
relation that it is in is off by the same factor, a minus sign or one of a unit, while a partner is
right elsewhere; the evidence is said, and the channel is left out rather than put right.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace

import numpy as np
from scipy import signal

from steering_core.parameters import ParameterSet
from steering_diagnosis.data.channels import MEASURED
from steering_diagnosis.data.record import PERIOD_S, Record
from steering_diagnosis.steering.smoothing import bridged, low_pass

FACTORS = {
    -1.0: "the wrong sign",
    180.0 / np.pi: "degrees for radians",
    np.pi / 180.0: "radians taken for degrees",
    1e3: "thousandths (mm, mN m, kPa for ...)",
    1e-3: "kilo-units (kN, kPa)",
    1e-5: "bar for Pa",
    1e-6: "MPa for Pa",
    1e5: "Pa taken for bar",
    1e6: "Pa taken for MPa",
}
"""What a measured value is too large by, and what that looks like."""

ALIKE = 0.85
"""Correlation from which two signals are the same but for a factor."""

CONSTANT_IS_FINE = ("supply_pressure",)
CLIPPED_RUN = 12
"""Equal samples in a row at a channel's extreme that a moving, noisy signal does not show."""

SEGMENT = 1000
FASTEST_HZ, LINE_HZ = 30.0, 3.0
"""No manoeuvre moves a rack faster; half the width of a line."""
SINGING = 0.1
"""Share of the rack speed's energy in one line above it, from which a gear sings."""

Signals = Mapping[str, np.ndarray]


@dataclass(frozen=True)
class Relation:
    """``name`` should equal ``of`` but for friction, noise and an offset.

    needs: other channels. judged: whether a wrong factor may belong to these instead.
    """

    name: str
    needs: tuple[str, ...]
    of: Callable[[Signals, ParameterSet], np.ndarray]
    systems: tuple[str, ...] = ("open_centre", "closed_centre", "servo_valve")
    judged: bool = True


@dataclass(frozen=True)
class Suspicion:
    """What is suspected. channels: those that it is about, left out of the replay."""

    text: str
    channels: tuple[str, ...]


def _load_pressure(s: Signals) -> np.ndarray:
    return s["right_pressure"] - s["left_pressure"]


def _pushed(s: Signals, p: ParameterSet) -> np.ndarray:
    torque = p["mechanics.gear_ratio"] * s["torsion_bar_torque"]
    return p["mechanics.piston_area"] * _load_pressure(s) + torque


def _rate(name: str) -> Callable[[Signals, ParameterSet], np.ndarray]:
    return lambda s, p: np.gradient(s[name], PERIOD_S)


CHAMBERS = ("left_pressure", "right_pressure")
VALVES = ("closed_centre", "servo_valve")
RELATIONS = (
    Relation(
        "steering_wheel_angle",
        ("rack_position",),
        lambda s, p: p["mechanics.gear_ratio"] * s["rack_position"],
    ),
    Relation("steering_wheel_speed", ("steering_wheel_angle",), _rate("steering_wheel_angle")),
    Relation("rack_speed", ("rack_position",), _rate("rack_position")),
    Relation(
        "steering_wheel_speed",
        ("rack_speed",),
        lambda s, p: p["mechanics.gear_ratio"] * s["rack_speed"],
    ),
    Relation("rack_force", ("torsion_bar_torque", *CHAMBERS), _pushed, judged=False),
    Relation("driver_torque", ("torsion_bar_torque",), lambda s, p: s["torsion_bar_torque"]),
    Relation("rack_force", ("load_force",), lambda s, p: s["load_force"]),
    Relation(
        "supply_pressure",
        CHAMBERS,
        lambda s, p: s["left_pressure"] + s["right_pressure"],
        ("open_centre",),
    ),
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


def suspicions(record: Record) -> list[Suspicion]:
    """Return what looks wrong with a record, before any inference."""
    found = _dead(record)
    dead = {channel for s in found for channel in s.channels}
    signals = {
        name: low_pass(bridged(values), 10.0)
        for name, values in record.channels.items()
        if name not in dead
    }
    swapped = _swapped(record, signals)
    if swapped is not None:
        found.append(swapped)
        signals = {n: values for n, values in signals.items() if n not in swapped.channels}
    return found + _wrong_factors(record, signals) + _clipped(record) + _singing(record, dead)


def without(record: Record, found: list[Suspicion]) -> Record:
    """Return the record without suspected channels; clipped samples are excluded from judgement."""
    gone = {channel for s in found for channel in s.channels}
    clipped = np.zeros(len(record), dtype=bool)
    for name in MEASURED:
        if name in record and name not in gone:
            clipped |= _clipping(record[name])
    excluded = record.excluded
    if clipped.any():
        excluded = clipped if excluded is None else excluded | clipped
    channels = {name: v for name, v in record.channels.items() if name not in gone}
    return replace(record, channels=channels, excluded=excluded)


def _dead(record: Record) -> list[Suspicion]:
    """Find channels that do not move at all in a record where the wheel or the rack does."""
    alive = [n for n in MEASURED if n in record and _moves(record[n])]
    moving = {"steering_wheel_angle", "rack_position", "torsion_bar_torque"} & set(alive)
    fine = CONSTANT_IS_FINE if record.valve_system != "open_centre" else ()
    return [
        Suspicion(
            f"{name} is constant ({np.nanmedian(record[name]):.4g} {MEASURED[name].unit}) while "
            f"{sorted(moving)[0]} moves: a dead sensor or a wrong channel",
            (name,),
        )
        for name in MEASURED
        if moving and name in record and name not in alive and name not in fine
    ]


def _moves(values: np.ndarray) -> bool:
    known = values[np.isfinite(values)]
    return len(known) > 0 and float(np.ptp(known)) > 0.0


def _swapped(record: Record, signals: Signals) -> Suspicion | None:
    """Find left and right pressure in each other's place, or a torque of the wrong sign."""
    if not {*CHAMBERS, "torsion_bar_torque"} <= set(signals):
        return None
    by_torque = correlation(_load_pressure(signals), signals["torsion_bar_torque"])
    if by_torque > -ALIKE:
        return None
    torque = signals["torsion_bar_torque"]
    by_hand = record.nominal["mechanics.gear_ratio"] * torque
    assist = record.nominal["mechanics.piston_area"] * _load_pressure(signals)
    if np.std(assist) < np.std(by_hand):
        # Not assisted, the rack's motion drives oil through the valve, against the torque.
        return None
    if "driver_torque" in signals and correlation(signals["driver_torque"], torque) < 0.0:
        return None
    if "rack_force" in signals:
        by_force = correlation(_load_pressure(signals), signals["rack_force"])
        if by_force > ALIKE:
            return Suspicion(
                "torsion_bar_torque seems to have the wrong sign: the load pressure goes against "
                f"it (correlation {by_torque:.2f}) and with the rack force ({by_force:.2f})",
                ("torsion_bar_torque",),
            )
    return Suspicion(
        "left_pressure and right_pressure seem to be swapped: the load pressure goes against the "
        f"torsion-bar torque (correlation {by_torque:.2f})",
        CHAMBERS,
    )


def _wrong_factors(record: Record, signals: Signals) -> list[Suspicion]:
    """Find channels that are off by a sign or a unit in all their relations."""
    votes: dict[str, list[tuple[float | None, str]]] = {}
    for relation in RELATIONS:
        members = (relation.name, *relation.needs)
        if record.valve_system not in relation.systems or not set(members) <= set(signals):
            continue
        expected = relation.of(signals, record.nominal)
        factor, text = _factor(signals[relation.name], expected, relation)
        for member in members if relation.judged else members[:1]:
            share = factor if member == relation.name or factor is None else 1.0 / factor
            votes.setdefault(member, []).append((share, text))
    suspected = []
    for name, cast in votes.items():
        wrong = {share for share, _ in cast if share is not None and share != 1.0}
        if len(wrong) == 1 and all(share in wrong for share, _ in cast) and name in MEASURED:
            suspected.append((name, wrong.pop(), cast))
    strongest = max((len(cast) for _, _, cast in suspected), default=0)
    return [
        Suspicion(f"{name} seems to have {_named(factor)}: {cast[0][1]}", (name,))
        for name, factor, cast in suspected
        if len(cast) == strongest or all(len(votes[n]) == len(cast) for n, _, _ in suspected)
    ]


def _factor(
    values: np.ndarray, expected: np.ndarray, relation: Relation
) -> tuple[float | None, str]:
    """Return 1, a known factor that ``values`` are too large by, or None where it is unclear."""
    alike = correlation(values, expected)
    if abs(alike) < ALIKE:
        return None, ""
    slope = float(np.sign(alike) * np.std(values) / np.std(expected))
    text = (
        f"against {' and '.join(relation.needs)} it is {slope:.3g} times what it should be "
        f"(correlation {alike:.2f})"
    )
    if 0.4 < slope < 2.5:
        return 1.0, text
    for factor in FACTORS:
        if factor * slope > 0.0 and 0.6 < slope / factor < 1.6:
            return factor, text
    return None, text


def _named(factor: float) -> str:
    nearest = min(FACTORS, key=lambda f: abs(f - factor) / abs(f))
    return "the wrong sign" if factor == -1.0 else f"a wrong unit ({FACTORS[nearest]})"


def _clipped(record: Record) -> list[Suspicion]:
    found = []
    for name in MEASURED:
        if name in record:
            clipped = _clipping(record[name])
            if clipped.any():
                level = record[name][clipped][0]
                found.append(
                    Suspicion(
                        f"{name} seems to be clipped at {level:.4g} {MEASURED[name].unit}: "
                        f"{int(clipped.sum())} samples stand still there; they are not judged",
                        (),
                    )
                )
    return found


def _singing(record: Record, dead: set[str]) -> list[Suspicion]:
    """Find a gear that oscillates by itself: one line holds much of what its rack does."""
    if "rack_speed" not in record or "rack_speed" in dead:
        return []
    speed = bridged(record["rack_speed"])
    hz, power = signal.welch(speed, 1.0 / PERIOD_S, nperseg=min(SEGMENT, len(speed)))
    above = hz > FASTEST_HZ
    k = int(np.argmax(np.where(above, power, 0.0)))
    line = power[(np.abs(hz - hz[k]) <= LINE_HZ) & above].sum() / max(power.sum(), 1e-300)
    if line < SINGING:
        return []
    return [
        Suspicion(
            f"the gear oscillates by itself at {hz[k]:.0f} Hz: {line:.0%} of the rack speed's "
            "energy is there. No replay follows such an oscillation in phase; record a manoeuvre "
            "in which it is silent",
            (),
        )
    ]


def _clipping(values: np.ndarray) -> np.ndarray:
    """Return the samples that stand still at the channel's extreme after moving into it, (n,)."""
    steps = np.abs(np.diff(values))
    moving = steps[np.isfinite(steps) & (steps > 0.0)]
    clipped = np.zeros(len(values), dtype=bool)
    if not len(moving):
        return clipped
    typical = 0.3 * float(np.median(moving))
    for level in (np.nanmax(values), np.nanmin(values)):
        at = np.concatenate([[0], (values == level).astype(np.int8), [0]])
        starts, ends = np.flatnonzero(np.diff(at) > 0), np.flatnonzero(np.diff(at) < 0)
        for start, end in zip(starts, ends, strict=True):
            abrupt = start > 0 and steps[start - 1] > typical
            if end - start >= CLIPPED_RUN and abrupt:
                clipped[start:end] = True
    return clipped


def correlation(first: np.ndarray, second: np.ndarray) -> float:
    """Return the correlation of two signals, 0 where one does not move."""
    if np.std(first) == 0.0 or np.std(second) == 0.0:
        return 0.0
    return float(np.corrcoef(first, second)[0, 1])
