"""The design problem (6.1 to 6.5): variables, bounds, objectives and penalties."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from scipy.optimize import brentq

from pressure_control.valve_design.simulation import NO_EFFECTS, STATES, simulate
from steering_core.parameters import ParameterSet, load_parameters
from steering_plant.control_valve import holes_area
from steering_plant.orifice import orifice_flow
from steering_plant.plant import plant_record

VARIABLES: dict[str, tuple[str, float, float]] = {
    "pressure_area_diameter": ("m", 1.0e-3, 3.0e-3),
    "spring_stiffness": ("N/m", 5.0e3, 6.0e4),
    "hole_diameter": ("m", 1.0e-3, 4.0e-3),
    "spring_preload": ("N", 0.0, 40.0),
}
"""Name in the group ``pressure_control_valve``: unit, lower and upper bound (chosen)."""

LOWER = np.array([low for _, low, _ in VARIABLES.values()])
UPPER = np.array([high for _, _, high in VARIABLES.values()])

LITRE_MINUTE, BAR = 1e-3 / 60.0, 1e5
POINTS: tuple[tuple[float, float], ...] = (
    (5.0 * BAR, -5.0 * LITRE_MINUTE),
    (5.0 * BAR, 5.0 * LITRE_MINUTE),
    (100.0 * BAR, -5.0 * LITRE_MINUTE),
    (100.0 * BAR, 1.1 * LITRE_MINUTE),
)
"""Extreme points of fig 6.3: chamber pressure [Pa] and load flow [m3/s] out of the chamber."""

STEP_BAR, STEP_TIME_S = 100.0, 0.5
SHORT_TIME_S = 0.06
"""Most designs have settled by then, and the rest of the half second need not be simulated."""

RAMP_S, POINT_TIME_S = 0.2, 0.3
"""The load flow of a point comes in slowly, or it would empty the chamber first."""

STEP_H, POINT_H = 2e-5, 4e-5
"""Time steps of the simulations [s]; the stiffest designs need less than 1e-4."""

INTEGRAL_GAIN = 100.0
"""Of the simple controller [1/s]; chosen: takes off a point's droop, up to 60 bar, in the time."""

RESTRICTOR_SHARE = 0.92
"""Of the restrictor criterion's limit (5.28), as on the data sheet."""

PENALTY = 10.0
"""A violated boundary weighs like ten normalised objectives, and by how far it is violated."""


@dataclass(frozen=True)
class Evaluation:
    """One design's figures. step_time [s] to 90 %, force [N], overshoot [Pa] above the step.

    forces: solenoid force at each of POINTS [N], NaN where the holes cannot pass the flow.
    deviations: |p_ref - p_l| at each point with the simple controller [Pa]. penalties: shape (6,),
    zero where a boundary is kept. settled: pressure after 0.5 s [Pa].
    """

    step_time: float
    force: float
    overshoot: float
    settled: float
    forces: tuple[float, ...]
    deviations: tuple[float, ...]
    penalties: np.ndarray

    @property
    def feasible(self) -> bool:
        """Whether every boundary is kept."""
        return bool(np.all(self.penalties == 0.0))


class DesignProblem:
    """The problem for one parameter set; a design is shape (4,), SI, in VARIABLES' order."""

    def __init__(self, parameters: ParameterSet | None = None) -> None:
        self.parameters = parameters or load_parameters()

    def parameters_of(self, design: np.ndarray) -> ParameterSet:
        """Return the set with a design's valve; its damping orifice follows from 5.28."""
        group = "pressure_control_valve"
        values = {f"{group}.{n}": float(v) for n, v in zip(VARIABLES, design, strict=True)}
        orifice = damping_orifice(self.parameters, float(design[0]))
        return self.parameters.with_values({**values, f"{group}.damping_orifice_diameter": orifice})

    def evaluate(self, design: np.ndarray) -> Evaluation:
        """Return a design's figures: one step of 100 bar, four extreme points."""
        par = plant_record(self.parameters_of(design), "closed_centre")
        pressure = step_response(par)
        forces = tuple(static_force(par[0], p, q) for p, q in POINTS)
        deviations = tuple(_deviation(par, p, q) for p, q in POINTS)
        time = step_time(pressure)
        usable = [force if math.isfinite(force) else 1e3 for force in forces]
        peak = float(pressure.max())
        return Evaluation(
            step_time=time,
            force=max(abs(force) for force in usable),
            overshoot=peak - STEP_BAR * BAR,
            settled=float(pressure[-1]),
            forces=forces,
            deviations=deviations,
            penalties=_penalties(float(pressure[-1]), peak, deviations),
        )


def run(
    par: np.ndarray,
    start: float,
    reference: float,
    flow: float,
    time: float,
    gain: float = 0.0,
    h: float = STEP_H,
) -> np.ndarray:
    """Return pressure, spool and force, (n, 3) every ``h``; NaN after the state left all bounds.

    gain: of the simple controller [1/s].
    """
    out = np.empty((round(time / h) + 1, 3))
    work = np.zeros((6, STATES))
    simulate(par, start, reference, flow, RAMP_S / h, gain, h, work, out, NO_EFFECTS)
    return out


def step_response(par: np.ndarray) -> np.ndarray:
    """Return the pressure [Pa] after a step from 0 to 100 bar without load flow, (n,).

    It ends early where the valve is quick; zeros where the simulation left all bounds.
    """
    pressure = run(par, 0.0, STEP_BAR * BAR, 0.0, SHORT_TIME_S)[:, 0]
    if pressure.max() < 0.9 * STEP_BAR * BAR:
        pressure = run(par, 0.0, STEP_BAR * BAR, 0.0, STEP_TIME_S)[:, 0]
    return pressure if np.all(np.isfinite(pressure)) else np.zeros(len(pressure))


def step_time(pressure: np.ndarray) -> float:
    """Return the time [s] to 90 % of the step, between samples; STEP_TIME_S where never."""
    wanted = 0.9 * STEP_BAR * BAR
    above = np.flatnonzero(pressure >= wanted)
    if not len(above) or above[0] == 0:
        return STEP_TIME_S
    k = int(above[0])
    share = (wanted - pressure[k - 1]) / (pressure[k] - pressure[k - 1])
    return (k - 1 + float(share)) * STEP_H


def damping_orifice(parameters: ParameterSet, pressure_area_diameter: float) -> float:
    """Return the damping orifice's diameter [m] at 0.92 of the restrictor criterion's limit.

    (5.28) K_1 = 2 A_c sqrt(V_c/(beta m)); K_1 is the orifice's conductance near zero drop.
    """
    valve, oil = parameters.group("pressure_control_valve"), parameters.group("oil")
    area = 0.25 * math.pi * pressure_area_diameter**2
    stiffness = oil["bulk_modulus"] * valve["spool_mass"]
    limit = 2.0 * area * math.sqrt(valve["control_chamber_volume"] / stiffness)
    transition = math.sqrt(valve["damping_orifice_transition_pressure"])
    unit = oil["flow_coefficient"] * math.sqrt(2.0 / oil["density"])
    return math.sqrt(4.0 / math.pi * RESTRICTOR_SHARE * limit * transition / unit)


def static_force(p: np.void, pressure: float, flow: float) -> float:
    """Return the solenoid force [N] that holds ``pressure`` at ``flow`` out of the chamber.

    Static 5.1 with 5.7: pressure, preload, spring and flow force. NaN where the holes, fully open,
    do not pass the flow.
    """
    spool = static_spool(p, pressure, flow)
    jet = 2.0 * p["flow_coefficient"] * p["jet_angle_cosine"]
    supply = holes_area(p["hole_diameter"], spool + p["underlap"])
    tank = holes_area(p["hole_diameter"], p["underlap"] - spool)
    flow_force = jet * (supply * abs(p["supply_pressure"] - pressure) - tank * abs(pressure))
    spring = p["spring_preload"] + p["spring_stiffness"] * spool
    return float(p["pressure_area"] * pressure + spring + flow_force)


def static_spool(p: np.void, pressure: float, flow: float) -> float:
    """Return the spool's displacement [m] at which ``flow`` leaves the chamber; NaN if none."""

    def surplus(spool: float) -> float:
        supply = holes_area(p["hole_diameter"], spool + p["underlap"])
        tank = holes_area(p["hole_diameter"], p["underlap"] - spool)
        transition, constant = p["laminar_transition_pressure"], p["orifice_constant"]
        inflow = orifice_flow(constant * supply, p["supply_pressure"] - pressure, transition)
        return float(inflow - orifice_flow(constant * tank, pressure, transition) - flow)

    travel = float(p["maximum_travel"])
    if surplus(-travel) > 0.0 or surplus(travel) < 0.0:
        return math.nan
    return float(brentq(surplus, -travel, travel, xtol=1e-12))


def _deviation(par: np.ndarray, pressure: float, flow: float) -> float:
    """Return |p_ref - p_l| [Pa] after the controller has settled; large where it cannot."""
    found = run(par, pressure, pressure, flow, POINT_TIME_S, INTEGRAL_GAIN, POINT_H)[:, 0]
    tail = found[-len(found) // 10 :]
    return float(np.max(np.abs(tail - pressure))) if np.all(np.isfinite(tail)) else 1e8


def _penalties(settled: float, peak: float, deviations: tuple[float, ...]) -> np.ndarray:
    """Return by how far each boundary is violated, in units of 100 bar; zero where it is kept."""
    step = STEP_BAR * BAR
    short = [0.9 * step - settled, peak - 1.05 * step]
    return np.maximum(np.array([*short, *(d - BAR for d in deviations)]) / step, 0.0)
