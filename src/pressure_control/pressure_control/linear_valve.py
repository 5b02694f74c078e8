"""The pressure control valve linearised at an operating point (source, section 5.1.2).

Names follow the source: K_q, K_c, K_e, K_f, K_1, K_v, w_v, w_s, w_0, d_0, K_s, R_v. Both edges
are counted, so that the region of the underlap, where both are open, is covered as well.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
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


@dataclass(frozen=True)
class LinearValve:
    """Linear coefficients of one valve with its chamber at an operating point, SI units.

    displacement [m]: positive opens to the supply. K_p [m2]: flow force per chamber pressure, the
    term K_f x_v0 that the source leaves out. It takes a share of A_c off the area by which the
    pressure closes the valve; the source's formulas are those of K_p = 0.
    """

    pressure: float
    supply: float
    displacement: float
    flow: float
    A_c: float
    K_q: float
    K_c: float
    K_e: float
    K_f: float
    K_1: float
    K_p: float
    V: float
    V_c: float
    beta: float
    mass: float
    damping: float

    @property
    def K_v(self) -> float:  # noqa: N802
        """Gain from reference to pressure with the loop open, at standstill (5.30)."""
        return self.A_c * self.K_q / (self.K_e * self.K_c)

    @property
    def loop_gain(self) -> float:
        """K_v with the share of A_c by which the pressure closes the valve."""
        return self.K_v * (1.0 - self.K_p / self.A_c)

    @property
    def w_v(self) -> float:
        """Corner of the spool against its damping orifice [rad/s] (5.27)."""
        return self.K_e * self.K_1 / self.A_c**2

    @property
    def w_s(self) -> float:
        """Corner of the chamber against the valve's leakage [rad/s]."""
        return self.beta * self.K_c / self.V

    @property
    def w_0(self) -> float:
        """Resonance of the valve under its own pressure [rad/s] (5.32)."""
        return math.sqrt((self.loop_gain + 1.0) * self.w_v * self.w_s)

    @property
    def d_0(self) -> float:
        """Damping of that resonance (5.33)."""
        return (self.w_v + self.w_s) / (2.0 * self.w_0)

    @property
    def K_s(self) -> float:  # noqa: N802
        """Static gain from reference to chamber pressure (5.34)."""
        return self.K_v / (1.0 + self.loop_gain)

    @property
    def R_v(self) -> float:  # noqa: N802
        """Droop of the static characteristic, -dp/dq [Pa s/m3] at constant reference (5.13)."""
        return self.K_e / (self.A_c * self.K_q)

    @property
    def restrictor_ratio(self) -> float:
        """Damping orifice over its largest value (5.28): above 1 the spool mode is not damped."""
        return self.K_1 / (2.0 * self.A_c * math.sqrt(self.V_c / (self.beta * self.mass)))


def linearise(
    parameters: ParameterSet,
    pressure: float,
    *,
    supply: float | None = None,
    displacement: float | None = None,
    flow: float | None = None,
    volume: float | None = None,
) -> LinearValve:
    """Linearise the valve at a chamber pressure [Pa].

    Give the spool's displacement [m] or the flow out of the valve [m3/s]; neither means the
    controller's nominal displacement, on the supply edge. supply [Pa] and volume [m3] default to
    the nominal ones. Raises ParameterError for a pressure outside of zero to supply, or a flow
    that the open valve cannot carry.
    """
    p = valve_record(parameters)[0]
    supply = parameters["closed_centre.supply_pressure"] if supply is None else supply
    if not 0.0 < pressure < supply:
        raise ParameterError(
            f"the operating pressure {pressure:g} Pa is not within 0 to {supply:g}"
        )
    if displacement is None:
        displacement = parameters["valve_controller.nominal_spool_displacement"]
        if flow is not None:
            displacement = displacement_for_flow(parameters, pressure, flow, supply=supply)
    areas = edge_areas(p, displacement)
    flow_gain, pressure_gain, stiffness, jet_area = edge_gains(p, *areas, pressure, supply)
    return LinearValve(
        pressure=pressure,
        supply=supply,
        displacement=displacement,
        flow=valve_flow(p, displacement, pressure, supply),
        A_c=float(p["pressure_area"]),
        K_q=flow_gain,
        K_c=pressure_gain,
        K_e=stiffness,
        K_f=float(p["jet_factor"]) * (areas[1] + areas[3]),
        K_1=float(p["damping_gain"]),
        K_p=jet_area,
        V=parameters["open_centre.chamber_volume"] if volume is None else volume,
        V_c=float(p["control_chamber_volume"]),
        beta=float(p["bulk_modulus"]),
        mass=float(p["spool_mass"]),
        damping=float(p["spool_damping"]),
    )


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


def state_space(valve: LinearValve) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Return A (4, 4), B (4, 2), C (1, 4) of spool, control chamber and chamber (5.17 to 5.23).

    States: displacement, spool velocity, control chamber pressure, chamber pressure. Inputs:
    pressure equivalent of the solenoid force [Pa] and load flow [m3/s]. Nothing is left out.
    """
    v = valve
    chamber, control = v.beta / v.V, v.beta / v.V_c
    a = np.array(
        [
            [0.0, 1.0, 0.0, 0.0],
            [-v.K_e / v.mass, -v.damping / v.mass, -v.A_c / v.mass, v.K_p / v.mass],
            [0.0, control * v.A_c, -control * v.K_1, control * v.K_1],
            [chamber * v.K_q, 0.0, chamber * v.K_1, -chamber * (v.K_c + v.K_1)],
        ]
    )
    b = np.array([[0.0, 0.0], [v.A_c / v.mass, 0.0], [0.0, 0.0], [0.0, -chamber]])
    return a, b, np.array([[0.0, 0.0, 0.0, 1.0]])


def simplified_response(valve: LinearValve, omega: np.ndarray) -> np.ndarray:
    """Return K_s/((s/w_0)^2 + 2 d_0 s/w_0 + 1) (5.31) at angular frequencies [rad/s]."""
    s = 1j * np.asarray(omega) / valve.w_0
    return valve.K_s / (s * s + 2.0 * valve.d_0 * s + 1.0)
