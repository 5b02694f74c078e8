"""The rig's load cylinder: servo valve, two chambers, piston with friction, load cell to the rack.

It takes the place of the ideal load force. The load cell is a stiff spring between piston and rack;
its force is what the rack feels and what /steering/rack reports. Signs as for the steering gear:
the right chamber pushes in the positive direction, so a positive load is a higher left pressure.
"""

from __future__ import annotations

from steering_core.compiled import kernel
from steering_plant.orifice import orifice_flow

from . import chamber, slots
from .friction import friction_rate, limited
from .servo_valve import share, spool_rates
from .states import (
    LOAD_LEFT,
    LOAD_RIGHT,
    LOAD_SPOOL,
    LOAD_VALVE,
    PISTON,
    PISTON_FRICTION,
    PISTON_SPEED,
    POSITION,
    VELOCITY,
)


@kernel
def cell_force(p, y):
    """Return the load cell's force [N]: positive opposes positive rack displacement."""
    first = int(p.load_cylinder)
    stretch = y[POSITION] - y[first + PISTON]
    return p.load_cell_stiffness * stretch + p.load_cell_damping * (
        y[VELOCITY] - y[first + PISTON_SPEED]
    )


@kernel
def piston_limit(p, y, e):
    """Return the limit of the piston's friction [N]."""
    speed = y[int(p.load_cylinder) + PISTON_SPEED]
    return slots.load_cylinder_friction_limit(p.load_friction, speed, y, e)


@kernel
def valve_flow(p, spool, pressure, y, e):
    """Return the flow [m3/s] into the chamber that a positive ``spool`` [m] feeds.

    Supply and tank edge of a four-way valve, open together by the underlap in the middle.
    """
    full = slots.flow_coefficient(p.orifice_constant, y, e) * p.load_full_opening
    inward = share(spool + p.load_underlap * p.servo_stroke, p.servo_stroke)
    outward = share(p.load_underlap * p.servo_stroke - spool, p.servo_stroke)
    transition = p.laminar_transition_pressure
    drawn = orifice_flow(full * inward, p.load_supply_pressure - pressure, transition)
    return drawn - orifice_flow(full * outward, pressure, transition)


@kernel
def load_cylinder_rates(p, y, dy, u, e):
    """Fill the rates of the load cylinder's states (7.1 to 7.3, nonlinear)."""
    first = int(p.load_cylinder)
    piston, speed = y[first + PISTON], y[first + PISTON_SPEED]
    left, right = y[first + LOAD_LEFT], y[first + LOAD_RIGHT]
    limit = piston_limit(p, y, e)
    friction = limited(y[first + PISTON_FRICTION], limit)
    pushing = (right - left) * p.load_piston_area + cell_force(p, y)
    stroke = p.load_piston_area * speed

    dy[first + PISTON] = speed
    dy[first + PISTON_SPEED] = (pushing - p.load_damping * speed - friction) / p.load_piston_mass
    growth = friction_rate(friction, limit, speed, p.load_friction_displacement)
    dy[first + PISTON_FRICTION] = growth
    spool = y[first + LOAD_SPOOL]
    left_volume = p.load_chamber_volume - p.load_piston_area * piston
    right_volume = p.load_chamber_volume + p.load_piston_area * piston
    left_net = valve_flow(p, spool, left, y, e) + stroke
    right_net = valve_flow(p, -spool, right, y, e) - stroke
    dy[first + LOAD_LEFT] = chamber.stiffness(p, left, y, e) / left_volume * left_net
    dy[first + LOAD_RIGHT] = chamber.stiffness(p, right, y, e) / right_volume * right_net
    spool_rates(p, y, dy, first + LOAD_SPOOL, u[LOAD_VALVE], e)
