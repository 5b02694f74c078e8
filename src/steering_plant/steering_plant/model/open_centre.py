"""Open-centre hydraulics: constant-flow pump with relief, Wheatstone bridge, three volumes."""

from __future__ import annotations

from steering_core.compiled import kernel
from steering_plant.boost_curve import opening_areas
from steering_plant.orifice import orifice_flow

from . import chamber, slots
from .states import (
    ENERGY,
    LEFT,
    LEFT_FLOW,
    PUMP,
    RIGHT,
    RIGHT_FLOW,
    SUPPLY_FLOW,
    VELOCITY,
)


@kernel
def relief_flow(p, pump):
    """Return the flow of the relief valve [m3/s]: linear above its opening pressure."""
    return p.relief_slope * max(pump - p.relief_pressure, 0.0)


@kernel
def bridge_areas(p, table, torque, y, e):
    """Return the bridge's areas (A1, A2) [m2]: with overlap each edge is where it closes sooner."""
    overlap = slots.valve_overlap(0.0, y, e)
    if overlap == 0.0:
        return opening_areas(p, table, torque)
    a1, _ = opening_areas(p, table, torque - overlap)
    _, a2 = opening_areas(p, table, torque + overlap)
    return a1, a2


@kernel
def open_centre_rates(p, table, time, y, dy, torque, flows, e):
    """Fill the rates of the chambers, the pump line and the supplied energy.

    Four orifices (section 4.2): pump to right and left to tank through A1, pump to left and right
    to tank through A2; the areas follow the torsion-bar torque [N m].
    """
    left, right, pump = y[LEFT], y[RIGHT], y[PUMP]
    a1, a2 = bridge_areas(p, table, slots.valve_torque(torque, y, e), y, e)
    coefficient = slots.flow_coefficient(p.orifice_constant, y, e)
    g1, g2 = coefficient * a1, coefficient * a2
    transition = p.laminar_transition_pressure

    to_right = orifice_flow(g1, pump - right, transition)
    to_left = orifice_flow(g2, pump - left, transition)
    right_net = to_right - orifice_flow(g2, right, transition)
    left_net = to_left - orifice_flow(g1, left, transition)
    right_net = slots.right_flow(right_net, left, right, y, e)
    left_net = slots.left_flow(left_net, left, right, y, e)
    supplied = slots.pump_flow(p.pump_flow, time, y, e)
    stroke = p.piston_area * y[VELOCITY]

    pump_net = supplied - relief_flow(p, pump) - (to_right + to_left)
    dy[PUMP] = chamber.stiffness(p, pump, y, e) / p.pump_volume * pump_net
    left_rate = chamber.stiffness(p, left, y, e) / chamber.left_volume(p, y, e)
    right_rate = chamber.stiffness(p, right, y, e) / chamber.right_volume(p, y, e)
    dy[LEFT] = left_rate * (left_net + stroke)
    dy[RIGHT] = right_rate * (right_net - stroke)
    dy[ENERGY] = pump * supplied
    flows[LEFT_FLOW], flows[RIGHT_FLOW], flows[SUPPLY_FLOW] = left_net, right_net, supplied
