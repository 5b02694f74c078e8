"""The limits on what is applied. Each is one line, so that each can be tested and broken alone.

All are odd in the torque, so left and right mirror each other to the bit.
"""

from __future__ import annotations

from typing import Any

from pressure_control.limits import bounded
from steering_core.compiled import kernel
from steering_core.ticks import TICK_PERIOD

TORQUE, PRESSURE, ACCELERATION, RATE, JERK = range(5)
"""Positions in the array of bounds, the first three [N m], the last two [N m] a tick."""


@kernel
def overlay_bounds(p: Any, gain: float, bounds: Any) -> None:
    """Write the bounds on torque and on its change to ``bounds``, shape (5,), [N m].

    gain: lateral acceleration per torque at the present speed [m/s2 per N m], positive.
    """
    bounds[TORQUE] = p.maximum_torque
    bounds[PRESSURE] = p.maximum_pressure / p.pressure_gain
    bounds[ACCELERATION] = p.maximum_lateral_acceleration / gain
    bounds[RATE] = p.maximum_rate * TICK_PERIOD
    bounds[JERK] = p.maximum_lateral_jerk * TICK_PERIOD / gain


@kernel
def limited_torque(wanted: float, bounds: Any) -> float:
    """Return ``wanted`` [N m] within the bounds of torque, pressure and lateral acceleration."""
    bound = min(bounds[TORQUE], bounds[PRESSURE], bounds[ACCELERATION])
    return bounded(wanted, -bound, bound)


@kernel
def limited_step(wanted: float, applied: float, bounds: Any) -> float:
    """Return the torque [N m] of this tick on the way from ``applied`` to ``wanted``.

    Within the bounds of rate and jerk. With both within torque and pressure bounds it stays there;
    a bound of lateral acceleration that falls with the speed is come down to at that rate.
    """
    step = min(bounds[RATE], bounds[JERK])
    return bounded(wanted, applied - step, applied + step)


@kernel
def note_limits(wanted: float, limited: float, applied: float, bounds: Any, flags: Any) -> None:
    """Set five ``flags`` to 1 where that bound on its own would have held back, else to 0.

    wanted [N m]: before the limits, limited: after those of level; applied: at the last tick.
    """
    for i in (TORQUE, PRESSURE, ACCELERATION):
        flags[i] = 1.0 if abs(wanted) > bounds[i] else 0.0
    for i in (RATE, JERK):
        flags[i] = 1.0 if abs(limited - applied) > bounds[i] else 0.0
