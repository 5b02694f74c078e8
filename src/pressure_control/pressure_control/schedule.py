"""The controller's picture of the valve at the present pressure and flow (source, section 6.2)."""

from __future__ import annotations

import math
from typing import Any

import numpy as np

from pressure_control.limits import bounded
from pressure_control.valve_gains import (
    closed_loop_poles,
    edge_areas,
    edge_gains,
    valve_record,
)
from steering_core.compiled import kernel
from steering_core.parameters import ParameterSet
from steering_plant.control_valve import HOLES, holes_area, holes_area_gradient
from steering_plant.orifice import orifice_flow

SMALLEST_STATIC_GAIN = 0.3
"""K_s is made up for down to this; a valve wide open at a small pressure drop has hardly any."""


@kernel
def opening_for_flow(
    p: Any, pressure: float, supply: float, flow: float
) -> tuple[float, float, float]:
    """Return area [m2], depth [m] and pressure drop [Pa] of the edge that carries ``flow`` [m3/s].

    Positive flow comes from the supply, negative goes to the tank.
    """
    drop = supply - pressure if flow >= 0.0 else pressure
    area = abs(flow) / orifice_flow(p.orifice_constant, drop, p.laminar_transition_pressure)
    area = min(area, p.largest_area)
    return area, uncovered_depth(p, area), drop


@kernel
def opening_at(p: Any, spool: float) -> tuple[float, float, float]:
    """Return (flow, area, depth) for ``scheduled_poles`` at a measured spool displacement [m].

    flow [m3/s] only tells the edge, going over from one to the other within the nominal
    displacement.
    """
    depth = bounded(abs(spool) + p.underlap, 0.0, 0.5 * p.hole_diameter)
    edge = p.schedule_flow_blend * spool / p.nominal_spool_displacement
    return edge, holes_area(p.hole_diameter, depth), depth


@kernel
def uncovered_depth(p: Any, area: float) -> float:
    """Return how far [m] the round holes must be uncovered for an area [m2].

    Two terms of the inverse series, within 1.6 % up to a third of the diameter.
    """
    depth = (area / p.depth_constant) ** (2.0 / 3.0)
    return depth * (1.0 + 0.2 * depth / p.hole_diameter)


@kernel
def scheduled_poles(
    p: Any,
    pressure: float,
    supply: float,
    flow: float,
    area: float,
    depth: float,
    rack_position: float,
) -> tuple[float, float, float]:
    """Return the valve's (w_0 [rad/s], d_0, K_s) for which the controller is set.

    pressure, supply [Pa]: measured. flow [m3/s]: estimated, out of the valve; area, depth: of
    opening_for_flow. The spool is taken to stand where the flow puts it, but no nearer to the
    middle than the nominal displacement; within schedule_flow_blend of zero flow the supply edge
    goes over to the tank edge. rack_position [m]: changes the chamber's volume.
    """
    open_area, open_gradient = p.wide_area, p.wide_gradient
    if area > open_area:
        open_area, open_gradient = area, holes_area_gradient(p.hole_diameter, depth)
    share = bounded(0.5 + 0.5 * flow / p.schedule_flow_blend, 0.0, 1.0)
    gains = edge_gains(
        p,
        share * open_area + (1.0 - share) * p.narrow_area,
        share * open_gradient + (1.0 - share) * p.narrow_gradient,
        share * p.narrow_area + (1.0 - share) * open_area,
        share * p.narrow_gradient + (1.0 - share) * open_gradient,
        pressure,
        supply,
    )
    stroke = bounded(rack_position, -p.rack_stop_position, p.rack_stop_position)
    volume = max(p.chamber_volume + p.piston_area * stroke, 0.1 * p.chamber_volume)
    w_0, d_0, static_gain = closed_loop_poles(p, gains[0], gains[1], gains[2], gains[3], volume)
    return w_0, d_0, max(static_gain, SMALLEST_STATIC_GAIN)


@kernel
def flow_feed_forward(p: Any, flow: float, area: float, depth: float, drop: float) -> float:
    """Return the demand [Pa] that opens the valve for ``flow`` [m3/s] at constant pressure.

    area, depth, drop: of opening_for_flow. The static force balance of the spool, A_c e = K x +
    flow force. For small changes of flow its slope is K_e/(A_c K_q), as in (6.9); the holes being
    round, that slope times the whole flow would fall short by up to a third.
    """
    displacement = max(depth - p.underlap, 0.0)
    if p.underlap < 0.0:
        # the closed zone is crossed within the blend rather than in one leap
        displacement += p.underlap * max(1.0 - abs(flow) / p.schedule_flow_blend, 0.0)
    force = p.spring_stiffness * displacement + p.jet_factor * area * drop
    return math.copysign(force, flow) / p.pressure_area


def schedule_fields(parameters: ParameterSet) -> dict[str, float]:
    """Return the constants that the kernels need beside those of the valve.

    Areas [m2] and gradients [m] of the edge that opens (wide) and of the other (narrow) at the
    nominal displacement; depth_constant [sqrt(m)]: area = constant depth^1.5 for small depths.
    """
    p = valve_record(parameters)[0]
    nominal = parameters["valve_controller.nominal_spool_displacement"]
    names = ("wide_area", "wide_gradient", "narrow_area", "narrow_gradient")
    diameter = parameters["pressure_control_valve.hole_diameter"]
    return dict(zip(names, edge_areas(p, nominal), strict=True)) | {
        "depth_constant": HOLES * 4.0 / 3.0 * math.sqrt(diameter),
        "largest_area": HOLES * np.pi / 8.0 * diameter**2,
    }
