"""What a cause does, found by trying it: its typical size, and which of its numbers are sizes.

A number that changes an output while the others stay at their first values is a size. One that
changes nothing alone, a Stribeck speed where there is no breakaway, is a shape. Typical is the
size that changes an output by a twentieth of its deviation, or the farthest bound.
"""

from __future__ import annotations

import itertools
from collections.abc import Callable, Mapping
from dataclasses import dataclass

import numpy as np

from balance_diagnosis.constants import Constants
from balance_diagnosis.errors import BalanceError
from balance_diagnosis.model import Cause, Number
from balance_diagnosis.priors import Prior, between

Change = Callable[[Mapping[str, float]], "np.ndarray | None"]

NOTHING = 1e-9
"""Change of an output, over its deviation, that is rounding."""

LEVELS = (1.0, 3.0, 9.0)
"""Changes at which a cause that is not linear is tried, in typical ones."""

HALVINGS = 12

SHAPES = (-0.5, 0.0, 0.5)
"""Places at which a shape is tried, in standard deviations from its middle."""

LINEAR = 0.999
"""Cosine of a small and of a large change of a cause that is linear in its size."""


class NothingError(BalanceError):
    """A cause changes nothing within its bounds."""


@dataclass(frozen=True)
class Probed:
    """A cause with what was found out about it.

    priors: of its numbers, sizes first. sizes: names of those that do something alone. trials:
    numbers at which it is tried, the first of them typical. linear: in its size, without a shape.
    """

    cause: Cause
    priors: dict[str, Prior]
    sizes: tuple[str, ...]
    trials: tuple[dict[str, float], ...]
    linear: bool
    typical: dict[str, float]

    @property
    def start(self) -> dict[str, float]:
        """The typical numbers."""
        return self.trials[0]


def probe(cause: Cause, change: Change, constants: Constants) -> Probed:
    """Try a cause. NothingError where it changes nothing within its bounds."""
    off = {n.name: n.off for n in cause.numbers}
    still = change(off)
    if still is None or strength(still) > NOTHING:
        raise BalanceError(
            f"cause '{cause.name}' is not off at its first values {off}: the prediction differs "
            "there from the one without it"
        )
    found = {n.name: _levels(n, change, constants.typical) for n in cause.numbers}
    sizes = {name: levels for name, levels in found.items() if levels}
    if not sizes:
        bounds = ", ".join(f"{n.name} {n.low:g} to {n.high:g}" for n in cause.numbers)
        raise NothingError(
            f"cause '{cause.name}' changes no output of any record within its bounds ({bounds}): "
            "take it out, or record a motion that shows it"
        )
    numbers = {n.name: n for n in cause.numbers}
    typical = {name: min(abs(v[0] - numbers[name].off) for v in s) for name, s in sizes.items()}
    priors = {
        name: Prior(numbers[name].off, constants.slab * size, numbers[name].low, numbers[name].high)
        for name, size in typical.items()
    }
    shapes = {n.name: _shape(n) for n in cause.numbers if n.name not in sizes}
    linear = not shapes and all(_linear(name, s, change, off) for name, s in sizes.items())
    trials = _trials(off, sizes, shapes, linear)
    return Probed(cause, {**priors, **shapes}, tuple(sizes), trials, linear, typical)


def strength(change: np.ndarray) -> float:
    """Return the size of a change: rms over the outputs' deviations."""
    return float(np.sqrt(change @ change))


def _levels(number: Number, change: Change, typical: float) -> list[list[float]]:
    """Return, for each side of off that does something, the values of typical and larger changes.

    The farthest bound stands for what is not reached.
    """
    sides = []
    for end in (number.high, number.low):
        if end == number.off:
            continue
        strengths: dict[float, float] = {}

        def at(share: float, end: float = end, known: dict[float, float] = strengths) -> float:
            if share not in known:
                made = change({number.name: number.off + share * (end - number.off)})
                known[share] = np.inf if made is None else strength(made)
            return known[share]

        if not at(1.0) > NOTHING and not at(0.5) > NOTHING:
            continue
        shares = [_reached(at, level * typical) for level in LEVELS]
        sides.append([number.off + s * (end - number.off) for s in dict.fromkeys(shares)])
    return sides


def _reached(at: Callable[[float], float], wanted: float) -> float:
    """Return the share of the way to a bound at which a change is reached, 1 where it is not."""
    high = 1.0
    if at(high) < wanted:
        return high
    low = 0.5
    while at(low) >= wanted and low > 2.0**-24:
        low, high = 0.5 * low, low
    for _ in range(HALVINGS):
        middle = 0.5 * (low + high)
        low, high = (middle, high) if at(middle) < wanted else (low, middle)
        if high - low < 0.02 * high:
            break
    return high


def _shape(number: Number) -> Prior:
    """Return the prior of a shape: all between its bounds is nearly as likely."""
    return between(number.low, number.high)


def _linear(name: str, sides: list[list[float]], change: Change, off: dict[str, float]) -> bool:
    """Return whether two sizes change the outputs alike, and in proportion."""
    a = sides[0][0]
    b = sides[-1][0] if len(sides) > 1 else off[name] + 0.5 * (a - off[name])
    first, second = change({name: a}), change({name: b})
    if first is None or second is None:
        return False
    ratio = (b - off[name]) / (a - off[name])
    missed = strength(second - ratio * first)
    return missed**2 <= (1.0 - LINEAR**2) * strength(second) ** 2


def _trials(
    off: dict[str, float],
    sizes: dict[str, list[list[float]]],
    shapes: dict[str, Prior],
    linear: bool,
) -> tuple[dict[str, float], ...]:
    """Return where a cause is tried: each size alone, beside each shape, typical sizes first."""
    places = [
        {name: off[name] for name in shapes},
        *(
            dict(zip(shapes, values, strict=True))
            for values in itertools.product(
                *([prior.value(x) for x in SHAPES] for prior in shapes.values())
            )
            if shapes
        ),
    ]
    levels = 1 if linear else len(LEVELS)
    made = [
        {**off, name: side[min(level, len(side) - 1)], **place}
        for level in range(levels)
        for place in places
        for name, sides in sizes.items()
        for side in (sides[:1] if linear else sides)
    ]
    unique: list[dict[str, float]] = []
    for trial in made:
        if trial not in unique:
            unique.append(trial)
    return tuple(unique)
