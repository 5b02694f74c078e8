"""The open-centre valve linearised at an operating point (source, section 4.3).

Two forms: the whole one, with all three volumes and four orifices, and the source's (4.15), which
takes p_right + p_left = p_s as instantaneous. docs/linear.md says where they part.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from scipy.optimize import root

from steering_core.parameters import ParameterError, ParameterSet
from steering_plant.boost_curve import FORMULA, opening_areas, static_pressures
from steering_plant.linear.linear_model import LinearModel
from steering_plant.orifice import orifice_flow, orifice_flow_gain
from steering_plant.plant import plant_record

TORQUE_STEP = 1e-5
"""Half width [N m] over which the areas' slopes are taken."""


@dataclass(frozen=True)
class OpenCentrePoint:
    """An operating point of the valve, SI units.

    torque [N m], load_flow [m3/s] into the right chamber, rack_position [m]; right, left, pump
    [Pa]; A1, A2 [m2] with their slopes w1, w2 [m2/(N m)] by torque.
    """

    p: Any
    torque: float
    load_flow: float
    rack_position: float
    right: float
    left: float
    pump: float
    A1: float
    A2: float
    w1: float
    w2: float

    @property
    def load_pressure(self) -> float:
        """p_right - p_left [Pa]."""
        return self.right - self.left

    @property
    def volumes(self) -> tuple[float, float, float]:
        """Volumes of the pump line, the right and the left chamber [m3]."""
        swept = float(self.p["piston_area"]) * self.rack_position
        chamber = float(self.p["chamber_volume"])
        return float(self.p["pump_volume"]), chamber + swept, chamber - swept


def open_centre_point(
    parameters: ParameterSet,
    torque: float,
    load_flow: float = 0.0,
    rack_position: float = 0.0,
    table: np.ndarray = FORMULA,
) -> OpenCentrePoint:
    """Return the steady state at a torsion-bar torque [N m] and load flow [m3/s].

    Solved from the nonlinear continuity of all three volumes, relief valve and laminar range
    included. Raises ParameterError where there is none.
    """
    p = plant_record(parameters, "open_centre", table)[0]
    areas = opening_areas(p, table, torque)
    right, left = static_pressures(p, table, torque, load_flow)
    scale = 1e5

    def unbalanced(bars: np.ndarray) -> list[float]:
        net = _net_flows(p, *areas, *(bars * scale))
        return [net[0] * 1e5, (net[1] - load_flow) * 1e5, (net[2] + load_flow) * 1e5]

    found = root(unbalanced, np.array([right + left, right, left]) / scale, tol=1e-13)
    if np.max(np.abs(found.fun)) > 1e-7 or found.x.min() * scale <= -float(
        p["atmospheric_pressure"]
    ):
        raise ParameterError(
            f"the open-centre valve has no steady state at {torque:g} N m and a load flow of "
            f"{load_flow * 6e4:g} l/min"
        )
    pump, right, left = (float(value) for value in found.x * scale)
    higher = opening_areas(p, table, torque + TORQUE_STEP)
    lower = opening_areas(p, table, torque - TORQUE_STEP)
    slopes = [(a - b) / (2.0 * TORQUE_STEP) for a, b in zip(higher, lower, strict=True)]
    return OpenCentrePoint(p, torque, load_flow, rack_position, right, left, pump, *areas, *slopes)


def whole_model(point: OpenCentrePoint) -> LinearModel:
    """Return the model of pump line, right and left chamber, nothing left out.

    Inputs: torsion-bar torque [N m], rack speed [m/s]. Outputs: load pressure, pump pressure [Pa].
    """
    p = point.p
    ps, pr, pl = point.pump, point.right, point.left
    k1, j1 = _slopes(p, point.A1, ps - pr)
    k2, j2 = _slopes(p, point.A2, pr)
    k3, j3 = _slopes(p, point.A2, ps - pl)
    k4, j4 = _slopes(p, point.A1, pl)
    relief = float(p["relief_slope"]) if ps > p["relief_pressure"] else 0.0
    w1, w2, area = point.w1, point.w2, float(p["piston_area"])
    a = np.array([[-k1 - k3 - relief, k1, k3], [k1, -k1 - k2, 0.0], [k3, 0.0, -k3 - k4]])
    b = np.array([[-j1 * w1 - j3 * w2, 0.0], [j1 * w1 - j2 * w2, -area], [j3 * w2 - j4 * w1, area]])
    stiffness = np.array([_modulus(p, x) for x in (ps, pr, pl)]) / np.array(point.volumes)
    return LinearModel(
        stiffness[:, None] * a,
        stiffness[:, None] * b,
        np.array([[0.0, 1.0, -1.0], [1.0, 0.0, 0.0]]),
        np.zeros((2, 2)),
        ("pump_pressure", "right_pressure", "left_pressure"),
        ("torque", "rack_speed"),
        ("load_pressure", "pump_pressure"),
    )


@dataclass(frozen=True)
class SourceGains:
    """The source's coefficients (4.9 to 4.15): flow gains [m3/(s N m)], others [m3/(s Pa)].

    V_0, V_s [m3]: load and pump volume; A_p [m2].
    """

    K_q1: float
    K_q2: float
    K_c1: float
    K_c2: float
    V_0: float
    V_s: float
    beta: float
    A_p: float

    @property
    def K_c(self) -> float:  # noqa: N802
        """Pressure gain at standstill (4.15)."""
        return (self.K_c1**2 - self.K_c2**2) / self.K_c1

    @property
    def K_q(self) -> float:  # noqa: N802
        """Flow gain at standstill; K_q/K_c is the boost curve's slope (4.15)."""
        return self.K_q1 * (1.0 + self.K_q2 * self.K_c2 / (self.K_q1 * self.K_c1))

    @property
    def w_0(self) -> float:
        """Resonance [rad/s]: beta sqrt((K_c1^2 - K_c2^2)/(V_0 V_s))."""
        return self.beta * np.sqrt((self.K_c1**2 - self.K_c2**2) / (self.V_0 * self.V_s))

    @property
    def d_0(self) -> float:
        """Damping of that resonance."""
        volumes = (self.V_0 + self.V_s) / np.sqrt(self.V_0 * self.V_s)
        return 0.5 * self.K_c1 / np.sqrt(self.K_c1**2 - self.K_c2**2) * volumes


def source_gains(point: OpenCentrePoint) -> SourceGains:
    """Return the coefficients at an operating point; w2 is negative for positive torque."""
    p = point.p
    flow, density = float(p["flow_coefficient"]), float(p["density"])
    high, low = point.pump - point.load_pressure, point.pump + point.load_pressure
    root1, root2 = np.sqrt(high / density), np.sqrt(low / density)
    c1 = flow * point.A1 / (2.0 * np.sqrt(high * density))
    c2 = flow * point.A2 / (2.0 * np.sqrt(low * density))
    pump, right, left = point.volumes
    return SourceGains(
        flow * (point.w1 * root1 - point.w2 * root2),
        flow * (point.w1 * root1 + point.w2 * root2),
        c1 + c2,
        c2 - c1,
        right * left / (right + left),
        pump,
        float(p["bulk_modulus"]),
        float(p["piston_area"]),
    )


def source_model(point: OpenCentrePoint) -> LinearModel:
    """Return (4.11 to 4.15) as a model of load and pump pressure, ports as ``whole_model``."""
    g = source_gains(point)
    load, pump = g.beta / g.V_0, g.beta / g.V_s
    return LinearModel(
        np.array([[-load * g.K_c1, -load * g.K_c2], [-pump * g.K_c2, -pump * g.K_c1]]),
        np.array([[load * g.K_q1, -load * g.A_p], [-pump * g.K_q2, 0.0]]),
        np.eye(2),
        np.zeros((2, 2)),
        ("load_pressure", "pump_pressure"),
        ("torque", "rack_speed"),
        ("load_pressure", "pump_pressure"),
    )


def _net_flows(
    p: Any, a1: float, a2: float, pump: float, right: float, left: float
) -> tuple[float, float, float]:
    """Return the net flows [m3/s] into pump line, right and left chamber, piston at rest."""
    g, transition = float(p["orifice_constant"]), float(p["laminar_transition_pressure"])
    to_right = orifice_flow(g * a1, pump - right, transition)
    to_left = orifice_flow(g * a2, pump - left, transition)
    relief = float(p["relief_slope"]) * max(pump - float(p["relief_pressure"]), 0.0)
    return (
        float(p["pump_flow"]) - relief - to_right - to_left,
        to_right - orifice_flow(g * a2, right, transition),
        to_left - orifice_flow(g * a1, left, transition),
    )


def _slopes(p: Any, area: float, drop: float) -> tuple[float, float]:
    """Return dq/d(drop) [m3/(s Pa)] and dq/d(area) [m/s] of an orifice."""
    g, transition = float(p["orifice_constant"]), float(p["laminar_transition_pressure"])
    gain = orifice_flow_gain(g * area, drop, transition)
    return float(gain), float(orifice_flow(g, drop, transition))


def _modulus(p: Any, pressure: float) -> float:
    vacuum = float(p["atmospheric_pressure"])
    ratio = (pressure + vacuum) / vacuum if pressure < 0.0 else 1.0
    return float(p["bulk_modulus"]) * ratio**2
