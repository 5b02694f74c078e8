"""Heading as the two numbers of a quaternion about the vertical axis."""

from __future__ import annotations

import math

from steering_core.compiled import kernel


@kernel
def half_angle(heading):
    """Return sine and cosine of half of ``heading`` [rad].

    Compiled, so that every user gets the same bits.
    """
    return math.sin(0.5 * heading), math.cos(0.5 * heading)
