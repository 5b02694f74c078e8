"""The pressure control valve linearised at an operating point (source, section 5.1.2).

Names follow the source: K_q, K_c, K_e, K_f, K_1, K_v, w_v, w_s, w_0, d_0, K_s, R_v. Both edges
are counted, so that the region of the underlap, where both are open, is covered as well.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from pressure_control.valve_gains import (
    displacement_for_flow,
    edge_areas,
    edge_gains,
    valve_flow,
    valve_record,
)
from steering_core.parameters import ParameterError, ParameterSet


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
