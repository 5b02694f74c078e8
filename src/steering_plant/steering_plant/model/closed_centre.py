"""Closed-centre hydraulics: one self-regulating pressure control valve for each chamber."""

from __future__ import annotations

from steering_core.compiled import kernel
from steering_plant.control_valve import holes_area
from steering_plant.orifice import orifice_flow

from . import chamber, slots
from .states import (
    CONTROL,
    ENERGY,
    LEFT,
    LEFT_FLOW,
    LEFT_SOLENOID,
    LEFT_VALVE,
    RIGHT,
    RIGHT_FLOW,
    RIGHT_SOLENOID,
    RIGHT_VALVE,
    SPOOL,
    SPOOL_SPEED,
    SUPPLY_FLOW,
    VELOCITY,
)


@kernel
def spool_stop_force(p, spool, speed):
    """Return the force of the spool's stops [N], spring and damper that push, never pull."""
    depth = abs(spool) - p.maximum_travel
    if depth <= 0.0:
        return 0.0
    outward = speed if spool > 0.0 else -speed
    size = max(p.spool_stop_stiffness * depth + p.spool_stop_damping * outward, 0.0)
    return size if spool > 0.0 else -size


@kernel
def valve_rates(p, y, dy, first, chamber_pressure, supply, force, resisting, e):
    """Fill the rates of one valve's spool and control chamber; return its flows.

    first: position of the valve's states. force: of the solenoid [N]. resisting: further force on
    the spool [N]. Returns (flow from the supply, flow into the chamber) [m3/s]. Equations 5.1 to
    5.7 with the signs of docs/equations: each edge's flow force closes it, the control chamber
    shrinks as the supply edge opens.
    """
    spool, speed, control = y[first + SPOOL], y[first + SPOOL_SPEED], y[first + CONTROL]
    opening = slots.spool_opening(spool, y, e)
    supply_area = holes_area(p.hole_diameter, opening + p.underlap)
    tank_area = holes_area(p.hole_diameter, p.underlap - opening)
    coefficient = slots.flow_coefficient(p.orifice_constant, y, e)
    transition = p.laminar_transition_pressure
    drop = supply - chamber_pressure

    # Nearly always one edge is shut: its roots need not be drawn.
    from_supply, to_tank = 0.0, 0.0
    if supply_area > 0.0:
        from_supply = orifice_flow(coefficient * supply_area, drop, transition)
    if tank_area > 0.0:
        to_tank = orifice_flow(coefficient * tank_area, chamber_pressure, transition)
    to_control = orifice_flow(
        p.damping_orifice_conductance,
        chamber_pressure - control,
        p.damping_orifice_transition_pressure,
    )
    jet = 2.0 * p.flow_coefficient * p.jet_angle_cosine
    flow_force = jet * (supply_area * abs(drop) - tank_area * abs(chamber_pressure))
    opposing = p.pressure_area * control + p.spring_preload + p.spring_stiffness * spool
    opposing += p.spool_damping * speed + flow_force + spool_stop_force(p, spool, speed)
    opposing += resisting

    dy[first + SPOOL] = speed
    dy[first + SPOOL_SPEED] = (force - opposing) / p.spool_mass
    control_stiffness = chamber.stiffness(p, control, y, e) / p.control_chamber_volume
    dy[first + CONTROL] = control_stiffness * (to_control + p.pressure_area * speed)
    return from_supply, from_supply - to_tank - to_control


@kernel
def closed_centre_rates(p, time, y, dy, u, flows, e):
    """Fill the rates of both valves, both chambers and the supplied energy."""
    left, right = y[LEFT], y[RIGHT]
    supply = slots.supply_pressure(p.supply_pressure, time, y, e)
    left_force = slots.left_solenoid(u[LEFT_SOLENOID], y, e)
    right_force = slots.right_solenoid(u[RIGHT_SOLENOID], y, e)
    left_spool, left_speed = y[LEFT_VALVE + SPOOL], y[LEFT_VALVE + SPOOL_SPEED]
    right_spool, right_speed = y[RIGHT_VALVE + SPOOL], y[RIGHT_VALVE + SPOOL_SPEED]
    on_left = slots.left_spool_force(0.0, left_spool, left_speed, y, e)
    on_right = slots.right_spool_force(0.0, right_spool, right_speed, y, e)
    left_drawn, left_net = valve_rates(p, y, dy, LEFT_VALVE, left, supply, left_force, on_left, e)
    right_drawn, right_net = valve_rates(
        p, y, dy, RIGHT_VALVE, right, supply, right_force, on_right, e
    )
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
