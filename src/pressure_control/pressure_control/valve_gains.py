"""Gains of the pressure control valve at a spool displacement, and the displacement for a flow."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
from scipy.optimize import brentq

from steering_core.compiled import kernel
from steering_core.parameters import ParameterError, ParameterSet, record
from steering_plant.control_valve import holes_area, holes_area_gradient
from steering_plant.orifice import orifice_flow, orifice_flow_gain


@kernel
def edge_gains(
    p: Any,
    supply_area: float,
    supply_gradient: float,
    tank_area: float,
    tank_gradient: float,
    pressure: float,
    supply: float,
) -> tuple[float, float, float, float]:
    """Return (K_q [m2/s], K_c [m3/(s Pa)], K_e [N/m], K_p [m2]) at a chamber pressure [Pa].

    The areas [m2] and their gradients [m] belong to the spool's displacement; the gradient of
    the tank edge counts positive. K_q = dq/dx (5.19), K_c = -dq/dp (5.20), K_e = spring and flow
    force (5.17), K_p = K_f x_v0, the flow force's part that grows with the chamber pressure and
    helps it. ``p`` holds the oil, the valve and the fields of ``valve_fields``.
    """
    drop = supply - pressure
    gain = p.orifice_constant
    transition = p.laminar_transition_pressure
    flow_gain = supply_gradient * orifice_flow(gain, drop, transition)
    flow_gain += tank_gradient * orifice_flow(gain, pressure, transition)
    pressure_gain = supply_area * orifice_flow_gain(gain, drop, transition)
    pressure_gain += tank_area * orifice_flow_gain(gain, pressure, transition)
    jet = supply_gradient * drop + tank_gradient * pressure
    stiffness = p.spring_stiffness + p.jet_factor * jet
    return flow_gain, pressure_gain, stiffness, p.jet_factor * (supply_area + tank_area)


@kernel
def closed_loop_poles(
    p: Any,
    flow_gain: float,
    pressure_gain: float,
    stiffness: float,
    jet_area: float,
    volume: float,
) -> tuple[float, float, float]:
    """Return (w_0 [rad/s], d_0, K_s) of the valve under its own pressure (5.30 to 5.34).

    The pressure that closes the valve acts on A_c less jet_area (K_p), which the source leaves
    out: a third of A_c at the tank edge in fast on-centre driving. volume [m3]: of the chamber.
    """
    w_v = stiffness * p.damping_gain / p.pressure_area**2
    w_s = p.bulk_modulus * pressure_gain / volume
    # K_v w_s, with K_c cancelled: finite where both edges are closed
    flow_rate = p.pressure_area * flow_gain * p.bulk_modulus / (stiffness * volume)
    closing = flow_rate * max(1.0 - jet_area / p.pressure_area, 0.0) + w_s
    w_0 = math.sqrt(closing * w_v)
    return w_0, (w_v + w_s) / (2.0 * w_0), flow_rate / closing


def valve_fields(parameters: ParameterSet) -> dict[str, float]:
    """Return the constants that the kernels need beside oil and valve.

    pressure_area [m2] (A_c); damping_gain [m3/(s Pa)] (K_1, the damping orifice in its linear
    range); orifice_constant = C_q sqrt(2/rho); jet_factor = 2 C_q cos(delta) (K_f = factor w).
    """
    oil, valve = parameters.group("oil"), parameters.group("pressure_control_valve")
    constant = oil["flow_coefficient"] * math.sqrt(2.0 / oil["density"])
    orifice = math.pi / 4.0 * valve["damping_orifice_diameter"] ** 2
    transition = valve["damping_orifice_transition_pressure"]
    return {
        "pressure_area": math.pi / 4.0 * valve["pressure_area_diameter"] ** 2,
        "damping_gain": constant * orifice / math.sqrt(transition),
        "orifice_constant": constant,
        "jet_factor": 2.0 * oil["flow_coefficient"] * valve["jet_angle_cosine"],
    }


def valve_record(parameters: ParameterSet) -> np.ndarray:
    """Return the record, shape (1,), that the kernels of this module take as ``p = record[0]``."""
    groups = parameters.group("oil") | parameters.group("pressure_control_valve")
    return record(groups | valve_fields(parameters))


def displacement_for_flow(
    parameters: ParameterSet, pressure: float, flow: float, *, supply: float | None = None
) -> float:
    """Return the spool's displacement [m] at which the valve delivers ``flow`` [m3/s]."""
    p = valve_record(parameters)[0]
    supply = parameters["closed_centre.supply_pressure"] if supply is None else supply
    travel = parameters["pressure_control_valve.maximum_travel"]
    if not all(
        sign * (valve_flow(p, sign * travel, pressure, supply) - flow) > 0.0 for sign in (-1.0, 1.0)
    ):
        raise ParameterError(f"the valve cannot carry {flow:g} m3/s at {pressure:g} Pa")
    return float(
        brentq(lambda x: valve_flow(p, x, pressure, supply) - flow, -travel, travel, xtol=1e-15)
    )


def valve_flow(p: Any, displacement: float, pressure: float, supply: float) -> float:
    """Return the flow [m3/s] from the valve into the chamber (5.2, 5.3)."""
    supply_area, _, tank_area, _ = edge_areas(p, displacement)
    constant, transition = p["orifice_constant"], p["laminar_transition_pressure"]
    inflow = orifice_flow(constant * supply_area, supply - pressure, transition)
    return float(inflow - orifice_flow(constant * tank_area, pressure, transition))


def edge_areas(p: Any, displacement: float) -> tuple[float, float, float, float]:
    """Return area [m2] and gradient [m] of the supply edge, then of the tank edge."""
    diameter, underlap = p["hole_diameter"], p["underlap"]
    return tuple(  # type: ignore[return-value]
        float(law(diameter, underlap + sign * displacement))
        for sign in (1.0, -1.0)
        for law in (holes_area, holes_area_gradient)
    )
