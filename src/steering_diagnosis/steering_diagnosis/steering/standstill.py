"""Where wheel and rack stand still their curves are smooth: noise there would shake friction loose.

Friction that holds a rack creeps when noise dithers it, in a replay as in a gear; but the gear felt
none of the sensors' noise. What a curve does during a standstill is a slow polynomial, as far as
nothing but noise is left of it.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence

import numpy as np
from numpy.polynomial import Polynomial

from steering_diagnosis.data.record import PERIOD_S
from steering_diagnosis.steering.smoothing import low_pass

SLOW = 0.02
"""Of a record's usual speed: what moves less stands still."""

SPEED_HZ = 20.0
SHORTEST_S = 0.3
TREMBLING_HZ, RESTLESS = (15.0, 120.0), 2.5
"""Where trembling shows in a speed, and from how many times white noise in that band; sensors'
noise is not quite white."""

DEGREE = 3
TRIMMED = (0.0, 0.15, 0.3, 0.5)
"""Shares of a standstill that are left out at its beginning, until what is left has settled."""

SMEARED = 100
"""Ticks at both ends of a standstill into which filters smear what moved before and after."""

BLEND = 40
"""Ticks in which a curve goes over into its polynomial."""


def standstills(positions: Iterable[np.ndarray]) -> list[slice]:
    """Return where none of the positions, (n,) each, moves."""
    still: np.ndarray | None = None
    for position in positions:
        speed = low_pass(np.gradient(position, PERIOD_S), SPEED_HZ)
        slow = np.abs(speed) < SLOW * np.sqrt(np.mean(speed**2))
        still = slow if still is None else still & slow
    if still is None:
        return []
    edges = np.diff(np.concatenate([[0], still.astype(np.int8), [0]]))
    found = zip(np.flatnonzero(edges > 0), np.flatnonzero(edges < 0), strict=True)
    return [slice(int(a), int(b)) for a, b in found if (b - a) * PERIOD_S >= SHORTEST_S]


def restful(where: Sequence[slice], rate: np.ndarray, noise: float) -> list[slice]:
    """Return the standstills in which a measured rate (n,) shows no trembling beyond its noise.

    noise: standard deviation of its samples. A driver who feels a sensor's noise really trembles.
    """
    low, high = TREMBLING_HZ
    fast = low_pass(rate, high) - low_pass(rate, low)
    most = RESTLESS * noise * np.sqrt(2.0 * (high - low) * PERIOD_S)
    inner = [slice(part.start + SMEARED, part.stop - SMEARED) for part in where]
    return [part for part, i in zip(where, inner, strict=True) if np.std(fast[i]) < most]


def calmed(values: np.ndarray, where: Sequence[slice], noise: float) -> np.ndarray:
    """Return ``values`` (n,) without what is noise during standstills.

    noise: standard deviation of the channel's samples, which smooth values stay below.
    """
    calm = values.copy()
    for still in where:
        length = still.stop - still.start
        for share in TRIMMED:
            part = slice(still.start + int(share * length), still.stop)
            if (part.stop - part.start) * PERIOD_S < SHORTEST_S:
                break
            ticks = np.arange(part.stop - part.start)
            slow = Polynomial.fit(ticks, values[part], DEGREE)(ticks)
            if np.std(values[part] - slow) < noise:
                inside = np.minimum(np.minimum(ticks, ticks[::-1]) / BLEND, 1.0)
                weight = 0.5 - 0.5 * np.cos(np.pi * inside)
                calm[part] += weight * (slow - values[part])
                break
    return calm
