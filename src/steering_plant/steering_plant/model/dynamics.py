"""The plant's right-hand side: mechanics with either hydraulic system, and the effects' states."""

from __future__ import annotations

from steering_core.compiled import kernel

from . import mechanics, slots
from .closed_centre import closed_centre_rates
from .open_centre import open_centre_rates
from .states import (
    COLUMN_FRICTION,
    CONTROL,
    LEFT,
    LEFT_VALVE,
    PUMP,
    RACK_FRICTION,
    RIGHT,
    RIGHT_VALVE,
)


@kernel
def rates(p, table, e, time, y, u, dy, flows):
    """Fill ``dy`` with the time derivative of the state ``y`` for held inputs ``u``.

    p: the plant's record. table: boost table. e: effects' parameters. time [s]. flows: left, right
    and supply flow [m3/s], left behind for reports.
    """
    torque = mechanics.torsion_bar_torque(p, y, e)
    mechanics.mechanical_rates(p, y, dy, u, torque, e)
    if p.closed_centre > 0.0:
        closed_centre_rates(p, time, y, dy, u, flows, e)
    else:
        open_centre_rates(p, table, time, y, dy, torque, flows, e)
    slots.effect_rates(time, y, dy, u, e)


@kernel
def settle(p, e, y):
    """Release the friction elements to their present limits, in place.

    Called after every inner step: a chamber pressure that fell has lowered the rack's limit.
    """
    column, rack = mechanics.column_limit(p, y, e), mechanics.rack_limit(p, y, e)
    y[COLUMN_FRICTION] = mechanics.limited(y[COLUMN_FRICTION], column)
    y[RACK_FRICTION] = mechanics.limited(y[RACK_FRICTION], rack)


@kernel
def possible(p, y):
    """Return whether the state is finite and every volume is above absolute zero pressure."""
    total = 0.0
    for value in y:
        total += abs(value)
    vacuum = -p.atmospheric_pressure
    if not (total < 1e15 and y[LEFT] > vacuum and y[RIGHT] > vacuum):
        return False
    if p.closed_centre > 0.0:
        return y[LEFT_VALVE + CONTROL] > vacuum and y[RIGHT_VALVE + CONTROL] > vacuum
    return y[PUMP] > vacuum
