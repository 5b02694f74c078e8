"""The plant's right-hand side: mechanics, one of the hydraulic systems, load, effects' states."""

from __future__ import annotations

from steering_core.compiled import kernel

from . import load_cylinder, mechanics, slots
from .closed_centre import closed_centre_rates
from .friction import limited
from .open_centre import open_centre_rates
from .servo_valve import servo_valve_rates
from .states import (
    COLUMN_FRICTION,
    CONTROL,
    LEFT,
    LEFT_VALVE,
    LOAD_LEFT,
    LOAD_RIGHT,
    PISTON_FRICTION,
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
    elif p.servo_valve > 0.0:
        servo_valve_rates(p, time, y, dy, u, flows, e)
    else:
        open_centre_rates(p, table, time, y, dy, torque, flows, e)
    if p.load_cylinder > 0.0:
        load_cylinder.load_cylinder_rates(p, y, dy, u, e)
    slots.effect_rates(time, y, dy, u, flows, e)


@kernel
def rates_between_pressures(p, e, time, y, u, dy, flows):
    """Fill ``dy`` as ``rates`` does where both chambers' pressures are given, and no valve.

    Nothing of the hydraulics then reaches the mechanics: its states rest, its flows are not known.
    """
    torque = mechanics.torsion_bar_torque(p, y, e)
    mechanics.mechanical_rates(p, y, dy, u, torque, e)
    if p.load_cylinder > 0.0:
        load_cylinder.load_cylinder_rates(p, y, dy, u, e)
    slots.effect_rates(time, y, dy, u, flows, e)


@kernel
def settle(p, e, y):
    """Release the friction elements to their present limits, in place.

    Called after every inner step: a chamber pressure that fell has lowered the rack's limit.
    """
    y[COLUMN_FRICTION] = limited(y[COLUMN_FRICTION], mechanics.column_limit(p, y, e))
    _, least, greatest = mechanics.rack_band(p, y, e)
    y[RACK_FRICTION] = min(max(y[RACK_FRICTION], least), greatest)
    if p.load_cylinder > 0.0:
        first = int(p.load_cylinder) + PISTON_FRICTION
        y[first] = limited(y[first], load_cylinder.piston_limit(p, y, e))


@kernel
def possible(p, y):
    """Return whether the state is finite and every volume is above absolute zero pressure."""
    total = 0.0
    for value in y:
        total += abs(value)
    vacuum = -p.atmospheric_pressure
    if not (total < 1e15 and y[LEFT] > vacuum and y[RIGHT] > vacuum):
        return False
    if p.load_cylinder > 0.0:
        first = int(p.load_cylinder)
        if not (y[first + LOAD_LEFT] > vacuum and y[first + LOAD_RIGHT] > vacuum):
            return False
    if p.closed_centre > 0.0:
        return y[LEFT_VALVE + CONTROL] > vacuum and y[RIGHT_VALVE + CONTROL] > vacuum
    return p.servo_valve > 0.0 or y[PUMP] > vacuum
