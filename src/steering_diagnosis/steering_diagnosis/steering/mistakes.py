"""What rigs get wrong in a channel, as something that can be undone: signs, units, exchanges, time.

A mistake is nothing but what it makes of the signals; whether it explains a record is judged in
one place (explained.py).
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass

import numpy as np

from steering_diagnosis.data.channels import MEASURED
from steering_diagnosis.data.record import Record
from steering_diagnosis.data.units import FACTORS
from steering_diagnosis.steering.relations import (
    ANGLE,
    CHAMBERS,
    FORCE,
    POSITION,
    STEP_S,
    TORQUE,
    Link,
    Signals,
    correlation,
)

LEAST_FACTOR = 1.9
"""Factor from which a unit may be wrong: below it are gains, which are effects of the catalogue."""

USUAL = {"rad", "deg", "rad/s", "deg/s", "N m", "Pa", "bar", "MPa", "m", "mm", "m/s", "mm/s", "N"}
"""Units of which one at least takes part in a mistake; two rare ones explain any factor."""

RARE = {"gon", "rev", "rev/s", "um", "hPa", "mbar", "N/mm2", "N mm", "mrad", "mrad/s"}
"""Units that are in no rig's record, or the same as another one."""

TOGETHER = 1.04
"""Factor within which no record tells two units apart, such as kgf and daN."""

WORDS = {
    180.0 / np.pi: " (degrees for radians)",
    np.pi / 180.0: " (radians for degrees)",
    1e3: " (thousandths)",
    1e-3: " (kilo-units)",
}
"""The commonest factors in words."""

TENTHS = (10.0, 100.0, 1e3, 1e4, 1e5, 1e6)
"""Factors of a scale that was forgotten or applied twice, as counts of a bus have them."""

ROAD_WHEEL = (11.0, 25.0)
"""Angle at the steering wheel over that at a road wheel: ratios of passenger cars. A torque behind
the gear is larger by the same."""

MOST_RATIO = 3.0
"""Pinions differ by less: 6 to 15 mm of rack a radian."""

ATMOSPHERE = 1.01325e5
"""Absolute pressure less gauge pressure [Pa], ISO 2533 at sea level."""

NONE_BELOW, BOTH_WAYS = 0.02, 0.1
"""Of its largest value: a magnitude goes below zero no further; and what it should follow goes both
ways by more."""

AROUND = (0.8, 1.6)
"""Lags that are tried, over that of a relation."""

AC_TIMES_S = (0.03, 0.1, 0.3, 1.0, 3.0)
"""Time constants of AC coupling that are tried."""

PRESSURES = (*CHAMBERS, "supply_pressure")
SPEEDS = {ANGLE: "steering_wheel_speed", POSITION: "rack_speed"}
GROUPS = (PRESSURES, CHAMBERS, *SPEEDS.items())
"""Channels that come from one device or one line of a mapping and are wrong together."""

EXCHANGED = (
    CHAMBERS,
    ("left_pressure", "supply_pressure"),
    ("right_pressure", "supply_pressure"),
    *SPEEDS.items(),
    (TORQUE, FORCE),
)
"""Channels that neighbouring plugs, columns or names make easy to exchange."""

Undo = Callable[[Signals], Mapping[str, np.ndarray]]


@dataclass(frozen=True)
class Mistake:
    """What may be wrong. undo: the signals as they would be without it, all of them.

    told: what seems to be. advice: what to write into the mapping. blamed: channels that are
    suspected; those that are changed by undoing it, unless given.
    """

    channels: tuple[str, ...]
    told: str
    advice: str
    undo: Undo
    blamed: tuple[str, ...] = ()

    @property
    def suspected(self) -> tuple[str, ...]:
        """Channels that are suspected."""
        return self.blamed or self.channels


def mistakes(
    record: Record, s: Signals, links: list[Link], lags: Mapping[int, float]
) -> Iterator[Mistake]:
    """Yield everything that may be wrong with the channels of a record, the simplest first.

    lags: by the number of a link, how much later its name seems to be [s].
    """
    measured = [name for name in MEASURED if name in s]
    groups = [g for g in GROUPS if set(g) <= set(s)] + [(name,) for name in measured]
    off = {name for link in links if link.state == "off" for name in link.relation.members}
    scaled = [group for group in groups if set(group) & off]
    for pair in EXCHANGED:
        if set(pair) <= set(s):
            yield _exchange(*pair)
    for group in scaled:
        if "pressure" not in group[0]:
            yield _scaled(group, -1.0, "have the wrong sign", "`sign: -1`")
    for group in scaled:
        yield from _units(record, group)
    for name, (low, high), told, advice in (
        (ANGLE, (1.0 / ROAD_WHEEL[1], 1.0 / ROAD_WHEEL[0]), "the road wheel", "map the wheel's"),
        (TORQUE, ROAD_WHEEL, "the far side of a reduction", "map the torsion bar's"),
    ):
        for factor in np.geomspace(low, high, 6) if name in off else ():
            yield _scaled((name,), float(factor), f"be measured at {told}", advice)
    for k, relation in enumerate(x.relation for x in links):
        for group in groups if lags.get(k) else ():
            if set(group) & set(relation.members):
                sign = 1.0 if relation.name in group else -1.0
                for lag in _lags(sign * lags[k]):
                    yield _late(group, lag)
    for link in (x for x in links if x.open):
        yield from _magnitudes(record, s, link)
        yield from _ac_coupled(link)
        yield from _offsets(link)
        yield from _ratio(link, s)
    for group in (PRESSURES, CHAMBERS):
        if set(group) <= set(s):
            yield _shifted(
                group, ATMOSPHERE, "be absolute, not gauge", f"`offset: -{ATMOSPHERE:.6g}` Pa"
            )


def _scaled(channels: tuple[str, ...], factor: float, told: str, advice: str) -> Mistake:
    return Mistake(channels, told, advice, lambda s: {**s, **{c: s[c] / factor for c in channels}})


def _shifted(
    channels: tuple[str, ...],
    offset: float,
    told: str,
    advice: str,
    blamed: tuple[str, ...] = (),
) -> Mistake:
    return Mistake(
        channels, told, advice, lambda s: {**s, **{c: s[c] - offset for c in channels}}, blamed
    )


def _exchange(first: str, second: str) -> Mistake:
    return Mistake(
        (first, second),
        "be swapped",
        "exchange their `from`",
        lambda s: {**s, first: s[second], second: s[first]},
    )


def _units(record: Record, group: tuple[str, ...]) -> Iterator[Mistake]:
    """Yield units in each other's place, then bare powers of ten; each with either sign."""
    for factor, told, advice in factors(MEASURED[group[0]].unit, record.units.get(group[0], "")):
        yield _scaled(group, factor, told, advice)
        if "pressure" not in group[0]:
            yield _scaled(group, -factor, f"{told}, of the wrong sign", f"{advice}, `sign: -1`")


def factors(si: str, said: str = "") -> list[tuple[float, str, str]]:
    """Return what channels may be too large by, what is told then, and what to do.

    said: the unit that they were read in; then only another true one has to be known. Units that
    no record tells apart are told together.
    """
    units = {name: one for name, one in FACTORS[si].items() if name not in RARE or name == said}
    said = said if said in units else si
    found = [(units[said] / one, true, said, f"unit: {true}") for true, one in units.items()]
    for wrong in units:
        for true, one in units.items():
            if {wrong, true} & USUAL:
                ratio = units[wrong] / one
                found.append((ratio, true, wrong, f"scale: {1.0 / ratio:.4g}"))
    found += [(f, "", "", f"scale: {1.0 / f:.4g}") for t in TENTHS for f in (t, 1.0 / t)]
    left = [x for x in found if max(x[0], 1.0 / x[0]) > LEAST_FACTOR]
    told = []
    while left:
        alike = [x for x in left if 1.0 / TOGETHER < x[0] / left[0][0] < TOGETHER]
        told.append(_told(alike))
        left = [x for x in left if x not in alike]
    return told


def _told(alike: list[tuple[float, str, str, str]]) -> tuple[float, str, str]:
    """Return one factor of those that are alike, and what is told of them."""
    factor, true, wrong, advice = alike[0]
    if not true:
        return factor, f"be off by a factor of {factor:.4g}", f"`{advice}`"
    others = [x for x in alike[1:] if x[2] == wrong and x[1] != true][:1]
    names = " or ".join(dict.fromkeys([true, *(x[1] for x in others)]))
    advices = " or ".join(dict.fromkeys(f"`{x[3]}`" for x in (alike[0], *others)))
    word = next((w for f, w in WORDS.items() if 1.0 / TOGETHER < f / factor < TOGETHER), "")
    return factor, f"be in {names}, taken for {wrong}{word}", advices


def _lags(lag: float) -> list[float]:
    """Return lags [s] about one: a sum of which a part is late shows less than that part's."""
    steps = abs(lag) / STEP_S
    tried = range(round(AROUND[0] * steps), round(AROUND[1] * steps) + 1)
    return [float(np.copysign(k * STEP_S, lag)) for k in tried if k]


def _late(group: tuple[str, ...], lag: float) -> Mistake:
    """Return the mistake that channels are late by a lag [s], or early."""
    steps = round(abs(lag) / STEP_S)

    def undo(s: Signals) -> dict[str, np.ndarray]:
        n = len(next(iter(s.values())))
        late, other = slice(steps, n), slice(0, n - steps)
        if lag < 0.0:
            late, other = other, late
        return {c: x[late if c in group else other] for c, x in s.items()}

    when = "late" if lag > 0.0 else "early"
    return Mistake(
        group,
        f"be {abs(lag):.2f} s {when}: another clock, trigger or filter",
        f"`delay: {lag:.2f}`, or a clock of its own",
        undo,
    )


def _magnitudes(record: Record, s: Signals, link: Link) -> Iterator[Mistake]:
    relation = link.relation
    values, expected = s[relation.name], relation.of(s, record.nominal)
    sides = [(relation.name, values, expected)]
    if len(relation.needs) == 1:
        sides.append((relation.needs[0], expected, values))
    for name, one, other in sides:
        low = -one.min() < NONE_BELOW * one.max()
        both = min(other.max(), -other.min()) > BOTH_WAYS * np.abs(other).max()
        alike = correlation(one, np.abs(other))
        if name in MEASURED and low and both and alike > abs(correlation(one, other)):
            sign = np.sign(other)
            yield Mistake(
                (name,),
                "be a magnitude without its sign",
                "join it with the channel of its sign before it is mapped",
                lambda s, name=name, sign=sign: {**s, name: sign * s[name]},  # type: ignore[misc]
            )


def _ac_coupled(link: Link) -> Iterator[Mistake]:
    names = (link.relation.name, *link.relation.needs) if link.relation.timed else ()
    for name in names if len(names) <= 2 else names[:1]:
        for time in AC_TIMES_S if name in MEASURED else ():

            def undo(s: Signals, name: str = name, time: float = time) -> dict[str, np.ndarray]:
                swing = s[name] - s[name].mean()
                return {**s, name: swing + np.cumsum(swing) * STEP_S / time}

            told = f"be AC-coupled, with about {time:g} s"
            yield Mistake((name,), told, "measure it with a DC-coupled amplifier", undo)


def _offsets(link: Link) -> Iterator[Mistake]:
    """Yield zeros that were not set: which of two encoders it is cannot be told."""
    relation = link.relation
    if link.apart and relation.name == ANGLE:
        told = f"be {link.offset:.3g} rad ({np.degrees(link.offset):.0f} deg) apart at the wheel"
        advice = f"zero them, or `offset: {-np.degrees(link.offset):.1f}` with `unit: deg`"
        yield _shifted((ANGLE,), link.offset, told, advice, relation.members)


def _ratio(link: Link, s: Signals) -> Iterator[Mistake]:
    """Yield another pinion than the data sheet's."""
    off = link.relation.beside and link.state == "off" and not link.apart
    if link.relation.name == ANGLE and off and 1.0 / MOST_RATIO < link.factor < MOST_RATIO:
        rack = tuple(c for c in (POSITION, SPEEDS[POSITION]) if c in s)
        told = f"have another ratio than the data sheet's: {link.factor:.3g} times as large"
        advice = "`parameters: {mechanics.gear_ratio: ...}`, or the `scale` of one of them"
        yield Mistake(
            rack,
            told,
            advice,
            lambda s: {**s, **{c: s[c] * link.factor for c in rack}},
            (ANGLE, POSITION),
        )
