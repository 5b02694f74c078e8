"""A lead or lag filter of first order, sampled: zero and pole go where the continuous ones do."""

from __future__ import annotations

import math

from steering_core.ticks import TICK_PERIOD


def sampled_lead(zero_rate: float, pole_rate: float) -> tuple[float, float, float]:
    """Return (gain, zero, pole) of gain (z - zero)/(z - pole), of unit static gain.

    zero_rate, pole_rate [rad/s]: of the continuous filter; its pole above its zero makes it a lead.
    With u given and y led: y = gain u + x, and x becomes pole y - gain zero u.
    """
    zero, pole = math.exp(-zero_rate * TICK_PERIOD), math.exp(-pole_rate * TICK_PERIOD)
    return (1.0 - pole) / (1.0 - zero), zero, pole
