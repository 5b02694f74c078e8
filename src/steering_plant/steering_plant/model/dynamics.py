"""The plant's right-hand side: mechanics with either hydraulic system, and the effects' states."""

from __future__ import annotations

from steering_core.compiled import kernel

from . import mechanics, slots
from .closed_centre import closed_centre_rates
from .open_centre import open_centre_rates
from .states import (
    ANGLE,
    CLOSED_CENTRE_SIZE,
    COLUMN_FRICTION,
    LEFT,
    OPEN_CENTRE_SIZE,
    POSITION,
    RACK_FRICTION,
    RIGHT,
    SPEED,
    VELOCITY,
)


@kernel
def model_size(p):
    """Return the number of states of the nominal model; the effects' states follow."""
    return CLOSED_CENTRE_SIZE if p.closed_centre > 0.0 else OPEN_CENTRE_SIZE


@kernel
def rates(par, table, e, time, y, u, dy, flows):
    """Fill ``dy`` with the time derivative of the state ``y`` for held inputs ``u``.

    par: the plant's record, shape (1,). table: boost table. e: effects' parameters. time [s].
    flows: left, right and supply flow [m3/s], left behind for reports.
    """
    p = par[0]
    size = model_size(p)
    z = y[size:]
    torque = mechanics.torsion_bar_torque(p, y[ANGLE], y[POSITION], z, e)
    mechanics.mechanical_rates(p, y, dy, u, torque, z, e)
    if p.closed_centre > 0.0:
        closed_centre_rates(p, time, y, dy, u, flows, z, e)
    else:
        open_centre_rates(p, table, time, y, dy, torque, flows, z, e)
    slots.effect_rates(time, y, dy, u, size, e)


@kernel
def settle(par, e, y):
    """Release the friction elements to their present limits, in place.

    Called after every inner step: a chamber pressure that fell has lowered the rack's limit.
    """
    p = par[0]
    z = y[model_size(p) :]
    column = mechanics.column_limit(p, y[SPEED], z, e)
    rack = mechanics.rack_limit(p, y[POSITION], y[VELOCITY], y[LEFT], y[RIGHT], z, e)
    y[COLUMN_FRICTION] = mechanics.limited(y[COLUMN_FRICTION], column)
    y[RACK_FRICTION] = mechanics.limited(y[RACK_FRICTION], rack)


@kernel
def possible(par, y):
    """Return whether the state is finite and both chambers are above absolute zero."""
    vacuum = -par[0].atmospheric_pressure
    for value in y:
        if not abs(value) < 1e15:
            return False
    return y[LEFT] > vacuum and y[RIGHT] > vacuum
