"""Opening of the pressure control valve: drilled holes uncovered by the spool."""

from __future__ import annotations

import math

import numpy as np
from numpy.polynomial import Chebyshev, Polynomial

from steering_core.compiled import kernel

HOLES = 4
"""Number of drilled holes on each edge (source, chapter 5)."""


def _segment_series(depth: np.ndarray) -> np.ndarray:
    """Return area/(d^2 sqrt(depth^3)) of a circle segment whose depth is a share of the diameter.

    The series of 2 sqrt(t (1 - t)) integrated term by term; it converges for shares up to a half.
    """
    total, factor = np.zeros_like(depth), 1.0
    for order in range(80):
        total += 2.0 * factor / (order + 1.5) * depth**order
        factor *= (order - 0.5) / (order + 1.0)
    return total


def _segment_coefficients() -> tuple[float, ...]:
    """Return the polynomial that replaces the series on 0 to 1/2, to 1.5e-13, in rising powers."""
    fit = Chebyshev.interpolate(_segment_series, 12, domain=[0.0, 0.5])
    return tuple(float(c) for c in fit.convert(kind=Polynomial).coef)


SEGMENT = _segment_coefficients()


@kernel
def segment_area(share):
    """Return the area of a circle segment over the diameter's square, for a depth up to a half.

    Faster than the arc cosine of the closed form, and the plant spends its time here. The terms are
    paired (Estrin's scheme), so that the processor need not wait for one after the other.
    """
    c0, c1, c2, c3, c4, c5, c6, c7, c8, c9, c10, c11, c12 = SEGMENT
    t2 = share * share
    t4 = t2 * t2
    low = (c0 + c1 * share) + (c2 + c3 * share) * t2
    middle = (c4 + c5 * share) + (c6 + c7 * share) * t2
    high = (c8 + c9 * share) + (c10 + c11 * share) * t2 + c12 * t4
    return share * math.sqrt(share) * (low + t4 * (middle + t4 * high))


@kernel
def holes_area(diameter, uncovered):
    """Return the open area [m2] of an edge's round holes.

    uncovered: depth [m] of the circle segment that the spool uncovers, spool displacement plus
    underlap; the area is zero below zero and full above one diameter.
    """
    if uncovered <= 0.0:
        return 0.0
    share = uncovered / diameter
    if share <= 0.5:
        area = segment_area(share)
    elif share < 1.0:
        area = 0.25 * math.pi - segment_area(1.0 - share)
    else:
        area = 0.25 * math.pi
    return HOLES * diameter * diameter * area


@kernel
def holes_area_gradient(diameter, uncovered):
    """Return d(area)/d(uncovered) [m], the area gradient w: the chords' lengths."""
    if uncovered <= 0.0 or uncovered >= diameter:
        return 0.0
    return HOLES * 2.0 * math.sqrt(uncovered * (diameter - uncovered))
