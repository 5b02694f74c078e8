"""Four servo valves: each chamber's meter-in and meter-out, driven by one command (section 7.2)."""

from __future__ import annotations

from steering_core.compiled import kernel
from steering_plant.orifice import orifice_flow

from . import chamber, slots
from .states import (
    ENERGY,
    LEFT,
    LEFT_FLOW,
    LEFT_SERVO,
    LEFT_SOLENOID,
    METER_IN,
    METER_OUT,
    RIGHT,
    RIGHT_FLOW,
    RIGHT_SERVO,
    RIGHT_SOLENOID,
    SUPPLY_FLOW,
    VELOCITY,
)


@kernel
def share(opening, stroke):
    """Return the open share of an edge, 0 to 1, at a spool displacement [m]."""
    return min(max(opening / stroke, 0.0), 1.0)


@kernel
def spool_rates(p, y, dy, first, command, e):
    """Fill the rates of a servo valve's spool, of second order as in (7.3).

    first: position of its displacement, its speed is the next. command: share of the stroke.
    """
    spool, speed = y[first], y[first + 1]
    wanted = p.servo_stroke * min(max(command, -1.0), 1.0)
    stiffness = p.servo_resonance * p.servo_resonance
    resisting = slots.spool_force(0.0, spool, speed, y, e) / p.servo_spool_mass
    dy[first] = speed
    dy[first + 1] = (
        stiffness * (wanted - spool) - 2.0 * p.servo_damping * p.servo_resonance * speed - resisting
    )


@kernel
def pair_rates(p, y, dy, first, pressure, supply, command, e):
    """Fill the rates of a chamber's two spools; return its flows.

    command c: the meter-in valve opens by bias + c, the meter-out valve by bias - c, so that both
    change the pressure alike (X_v2 = -X_v1). Returns (flow from the supply, flow into the
    chamber) [m3/s], the orifice law behind (7.5) and (7.6).
    """
    spool_rates(p, y, dy, first + METER_IN, p.servo_bias + command, e)
    spool_rates(p, y, dy, first + METER_OUT, p.servo_bias - command, e)
    inward = share(slots.spool_opening(y[first + METER_IN], y, e), p.servo_stroke)
    outward = share(slots.spool_opening(y[first + METER_OUT], y, e), p.servo_stroke)
    full = slots.flow_coefficient(p.orifice_constant, y, e) * p.servo_full_opening
    transition = p.laminar_transition_pressure
    drawn = orifice_flow(full * inward, supply - pressure, transition)
    return drawn, drawn - orifice_flow(full * outward, pressure, transition)


@kernel
def servo_valve_rates(p, time, y, dy, u, flows, e):
    """Fill the rates of the four valves, both chambers (7.7) and the supplied energy."""
    left, right = y[LEFT], y[RIGHT]
    supply = slots.supply_pressure(p.supply_pressure, time, y, e)
    left_drawn, left_net = pair_rates(p, y, dy, LEFT_SERVO, left, supply, u[LEFT_SOLENOID], e)
    right_drawn, right_net = pair_rates(p, y, dy, RIGHT_SERVO, right, supply, u[RIGHT_SOLENOID], e)
    left_net = slots.left_flow(left_net, left, right, y, e)
    right_net = slots.right_flow(right_net, left, right, y, e)
    stroke = p.piston_area * y[VELOCITY]

    left_rate = chamber.stiffness(p, left, y, e) / chamber.left_volume(p, y, e)
    right_rate = chamber.stiffness(p, right, y, e) / chamber.right_volume(p, y, e)
    dy[LEFT] = left_rate * (left_net + stroke)
    dy[RIGHT] = right_rate * (right_net - stroke)
    dy[ENERGY] = supply * (left_drawn + right_drawn)
    flows[LEFT_FLOW], flows[RIGHT_FLOW] = left_net, right_net
    flows[SUPPLY_FLOW] = left_drawn + right_drawn
