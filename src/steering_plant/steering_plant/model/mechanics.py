"""Steering wheel and rack: two degrees of freedom (eq. 4.1, 4.2), friction elements, end stops."""

from __future__ import annotations

from steering_core.compiled import kernel

from . import load_cylinder, slots
from .friction import friction_rate, limited, yielding_rate
from .states import (
    ANGLE,
    COLUMN_FRICTION,
    DRIVER_TORQUE,
    LEFT,
    LOAD_FORCE,
    LOAD_POSITION,
    LOAD_STIFFNESS,
    POSITION,
    RACK_FRICTION,
    RIGHT,
    SPEED,
    VELOCITY,
)


@kernel
def column_limit(p, y, e):
    """Return the limit of the column's friction [N m]."""
    return slots.column_friction_limit(p.column_friction, y[SPEED], y, e)


@kernel
def rack_band(p, y, e):
    """Return the rack's friction [N]: nominal limit, least and greatest force.

    Nominally level plus slope times the sum of the pressures, alike in both directions.
    """
    left, right = y[LEFT], y[RIGHT]
    loaded = max(left, 0.0) + max(right, 0.0)
    nominal = p.rack_friction + p.rack_friction_pressure_slope * loaded
    limit = slots.rack_friction_limit(nominal, y[POSITION], y[VELOCITY], left, right, y, e)
    middle = slots.rack_friction_middle(0.0, limit, y[POSITION], y[VELOCITY], y, e)
    return nominal, middle - limit, middle + limit


@kernel
def torsion_bar_torque(p, y, e):
    """Return T = K_T (theta_sw - R_T x) [N m]."""
    twist = y[ANGLE] - p.gear_ratio * y[POSITION]
    return slots.torsion_torque(p.torsion_bar_stiffness * twist, twist, y, e)


@kernel
def load(p, u, y, e):
    """Return the rack force [N]: force + stiffness (x - its position), or the load cylinder's."""
    if p.load_cylinder > 0.0:
        return load_cylinder.cell_force(p, y)
    nominal = u[LOAD_FORCE] + u[LOAD_STIFFNESS] * (y[POSITION] - u[LOAD_POSITION])
    return slots.load_force(nominal, y[POSITION], y[VELOCITY], y, e)


@kernel
def stop_force(p, position, velocity):
    """Return the force of the end stops [N]: spring and damper that push, never pull."""
    depth = abs(position) - p.rack_stop_position
    if depth <= 0.0:
        return 0.0
    outward = velocity if position > 0.0 else -velocity
    size = max(p.rack_stop_stiffness * depth + p.rack_stop_damping * outward, 0.0)
    return size if position > 0.0 else -size


@kernel
def mechanical_rates(p, y, dy, u, torque, e):
    """Fill the rates of the mechanical states for a torsion-bar ``torque`` [N m]."""
    speed, position, velocity = y[SPEED], y[POSITION], y[VELOCITY]
    left, right = y[LEFT], y[RIGHT]
    column = column_limit(p, y, e)
    nominal, least, greatest = rack_band(p, y, e)
    column_force = limited(y[COLUMN_FRICTION], column)
    rack_force = min(max(y[RACK_FRICTION], least), greatest)

    resisting = p.steering_wheel_damping * speed + column_force
    resisting += slots.column_torque(0.0, y[ANGLE], speed, y, e)
    opposing = p.rack_damping * velocity + rack_force + load(p, u, y, e)
    opposing += stop_force(p, position, velocity)
    opposing += slots.rack_force(0.0, position, velocity, left, right, y, e)
    assistance = (right - left) * p.piston_area

    dy[ANGLE] = speed
    dy[SPEED] = (u[DRIVER_TORQUE] - torque - resisting) / p.steering_wheel_inertia
    dy[POSITION] = velocity
    dy[VELOCITY] = (assistance + torque * p.gear_ratio - opposing) / p.rack_mass
    dy[COLUMN_FRICTION] = friction_rate(column_force, column, speed, p.column_friction_angle)
    reached = greatest if velocity > 0.0 else -least
    dy[RACK_FRICTION] = yielding_rate(
        rack_force, nominal, reached, velocity, p.rack_friction_displacement
    )
