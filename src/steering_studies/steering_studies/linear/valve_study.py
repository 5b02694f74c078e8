"""The pressure control valve alone (figs 6.5, 6.6, 6.7) and its restrictor criterion (5.28)."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np

from pressure_control.linear_valve import LinearValve, linearise, state_space
from pressure_control.valve_diagram import (
    general_loop_gain,
    general_response,
    simplified_loop_gain,
)
from pressure_control.valve_gains import edge_areas, valve_record
from pressure_control.valve_static import holding_demand, pressure_under_flow
from steering_core.parameters import ParameterSet
from steering_plant.model import states
from steering_plant.model.integrator import OK, advance
from steering_plant.orifice import orifice_flow
from steering_plant.plant import Plant, PlantError, failure_text
from steering_plant.rest import rest_solenoid_force
from steering_studies.linear.bode import Family, Margins, grid, margins
from steering_studies.linear.open_centre_study import LITRE_PER_MINUTE, StaticCurves

PRESSURES = np.array([5.0, 15.0, 50.0, 100.0]) * 1e5
"""Chamber pressures [Pa] at which the valve is looked at."""

FLOWS = (-2.0 * LITRE_PER_MINUTE, 2.0 * LITRE_PER_MINUTE)
"""Load flows [m3/s] at which the restrictor is judged, as in fast on-centre driving."""

HEAVY = 1e9
"""Rack mass [kg] that holds the piston, or keeps it going."""

FINE = 5e-5
"""Period [s] of the samples of a step."""


def static_characteristic(parameters: ParameterSet, points: int = 41) -> StaticCurves:
    """Return fig 6.5: chamber pressure over load flow at a constant demand, -5 to +5 l/min.

    ``torque`` holds the chamber's pressures at standstill [Pa] in place of torques.
    """
    flow = np.linspace(-5.0, 5.0, points) * LITRE_PER_MINUTE
    rows = [pressure_under_flow(parameters, closed, flow) for closed in PRESSURES]
    return StaticCurves(PRESSURES, flow, np.array(rows))


def highest_gain(parameters: ParameterSet) -> LinearValve:
    """Return the valve where its loop gain is highest: hardly open, over all pressures."""
    pressures = np.linspace(2.0, 150.0, 75) * 1e5
    found = [linearise(parameters, float(p), flow=0.0) for p in pressures]
    return max(found, key=lambda valve: valve.loop_gain)


def loop_gain(parameters: ParameterSet, general: bool = True) -> Family:
    """Return fig 6.6: the valve's loop gain at its highest; ``torque`` holds the pressure [Pa].

    general: fig 5.2 with everything; otherwise the simplified (5.30).
    """
    valve, hertz = highest_gain(parameters), grid()
    law = general_loop_gain if general else simplified_loop_gain
    response = law(valve, 2j * np.pi * hertz)[None, :]
    pressure = np.array([valve.pressure])
    return Family("6.6", "pressure control valve: loop gain", hertz, pressure, response, True)


@dataclass(frozen=True)
class Validity:
    """How far the simplified diagram holds at one restrictor.

    ratio: K_1 over its limit (5.28). decibel, degrees: largest difference of the closed response
    up to 100 Hz. leaves [Hz]: where it passes 1 dB or 5 degrees (nan: nowhere to 1 kHz). margins:
    of the general loop. damping: of the least damped pole with |s| above 100 rad/s; growth [1/s]:
    largest real part over the FLOWS at 50 bar. ripple [Pa]: largest peak to peak of the chamber's
    pressure in the nonlinear simulation over the same flows, 0.12 to 0.15 s after a step of 1 bar.
    """

    ratio: float
    decibel: float
    degrees: float
    leaves: float
    margins: Margins
    damping: float
    growth: float
    ripple: float


def restrictor_validity(
    parameters: ParameterSet, ratios: Sequence[float] = (0.5, 0.92, 2.0, 4.0, 8.0)
) -> list[Validity]:
    """Compare general and simplified diagram, and simulate, for restrictors within and beyond."""
    nominal = linearise(parameters, 5e5, flow=0.0).restrictor_ratio
    diameter = parameters["pressure_control_valve.damping_orifice_diameter"]
    name = "pressure_control_valve.damping_orifice_diameter"
    return [
        _validity(parameters.with_values({name: diameter * np.sqrt(ratio / nominal)}))
        for ratio in ratios
    ]


def _validity(parameters: ParameterSet) -> Validity:
    valve, hertz = highest_gain(parameters), grid()
    s = 2j * np.pi * hertz
    simple = valve.K_s / ((s / valve.w_0) ** 2 + 2.0 * valve.d_0 * s / valve.w_0 + 1.0)
    ratio = simple / general_response(valve, s)
    decibel, degrees = np.abs(20.0 * np.log10(np.abs(ratio))), np.abs(np.degrees(np.angle(ratio)))
    low, beyond = hertz <= 100.0, (decibel > 1.0) | (degrees > 5.0)
    poles = np.linalg.eigvals(state_space(valve)[0])
    fast = poles[np.abs(poles) > 100.0]
    return Validity(
        valve.restrictor_ratio,
        float(decibel[low].max()),
        float(degrees[low].max()),
        float(hertz[beyond.argmax()]) if beyond.any() else np.nan,
        margins(hertz, general_loop_gain(valve, s)),
        float(np.min(-fast.real / np.abs(fast))),
        largest_growth(parameters),
        max(_ripple(parameters, flow) for flow in FLOWS),
    )


def largest_growth(parameters: ParameterSet, pressure: float = 50e5) -> float:
    """Return the largest real part [1/s] of the valve's poles over FLOWS at a pressure [Pa]."""
    valves = [linearise(parameters, pressure, flow=flow) for flow in FLOWS]
    return max(float(np.linalg.eigvals(state_space(v)[0]).real.max()) for v in valves)


def restrictor_onset(parameters: ParameterSet) -> tuple[float, float]:
    """Return the restrictor ratio at which the valve alone goes unstable: (linear, simulated).

    Simulated: the ripple of the nonlinear valve passes 1 bar.
    """
    nominal = linearise(parameters, 5e5, flow=0.0).restrictor_ratio
    name = "pressure_control_valve.damping_orifice_diameter"

    def at(ratio: float) -> ParameterSet:
        return parameters.with_values({name: parameters[name] * np.sqrt(ratio / nominal)})

    linear = _bisected(lambda ratio: largest_growth(at(ratio)) > 0.0, 0.5, 20.0, 16)
    simulated = _bisected(lambda ratio: max(_ripple(at(ratio), q) for q in FLOWS) > 1e5, 0.5, 20, 6)
    return linear, simulated


def _bisected(passes: Callable[[float], bool], low: float, high: float, steps: int) -> float:
    """Return about where ``passes`` turns true, halving in the logarithm."""
    for _ in range(steps):
        middle = float(np.sqrt(low * high))
        low, high = (low, middle) if passes(middle) else (middle, high)
    return float(np.sqrt(low * high))


def _ripple(parameters: ParameterSet, flow: float) -> float:
    step = valve_step(parameters, 50e5, 51e5, duration=0.15, flow=flow)
    late = step.pressure[step.time > 0.12]
    trend = np.polyval(np.polyfit(np.arange(len(late)), late, 2), np.arange(len(late)))
    return float(np.ptp(late - trend))


@dataclass(frozen=True)
class ValveStep:
    """A step of the valve's demand with the piston held: time [s], pressure [Pa], spool [m] (n,).

    low, high [Pa]: pressures at rest before and after.
    """

    time: np.ndarray
    pressure: np.ndarray
    spool: np.ndarray
    low: float
    high: float

    def reaches(self, share: float) -> float:
        """Return the time [s] after which the pressure stays beyond a share of the step."""
        done = (self.pressure - self.low) / (self.high - self.low)
        below = np.flatnonzero(done < share)
        return float(self.time[min(below[-1] + 1, len(self.time) - 1)]) if len(below) else 0.0

    def first_reaches(self, share: float) -> float:
        """Return the time [s] at which the pressure first passes a share of the step."""
        done = (self.pressure - self.low) / (self.high - self.low)
        return float(self.time[int(np.argmax(done >= share))])

    @property
    def overshoot(self) -> float:
        """Return how far [Pa] the pressure goes beyond its final value."""
        sign = np.sign(self.high - self.low)
        return max(float(np.max(sign * (self.pressure - self.high))), 0.0)


def valve_step(
    parameters: ParameterSet,
    low: float,
    high: float,
    *,
    duration: float = 0.05,
    lead: float = 0.0,
    flow: float = 0.0,
) -> ValveStep:
    """Step the right valve's demand from holding ``low`` to holding ``high`` [Pa] (fig 6.7).

    lead [s]: a lead on the solenoid's force, lead (d/dt) of a demand that rises within 1 ms.
    flow [m3/s]: into the chamber, by the piston's motion.
    """
    plant = Plant(parameters.with_values({"mechanics.rack_mass": HEAVY}), "closed_centre")
    valves = [linearise(parameters, p, flow=flow) for p in (low, high)]
    demands = [holding_demand(parameters, valve) for valve in valves]
    y, u, first = plant.state, plant.inputs, states.RIGHT_VALVE
    y[first + states.SPOOL] = valves[0].displacement
    y[first + states.CONTROL] = y[states.RIGHT] = low
    p = plant.par[0]
    y[states.VELOCITY] = flow / p["piston_area"]
    u[states.LEFT_SOLENOID] = rest_solenoid_force(p, float(y[states.LEFT]))
    count = round(duration / FINE)
    rows = np.empty((count, 2))
    for k in range(count):
        rows[k] = y[states.RIGHT], y[first + states.SPOOL]
        wanted = demands[1] + (demands[1] - demands[0]) * lead / 1e-3 * (k * FINE < 1e-3)
        force = wanted * p["pressure_area"] + p["spring_preload"]
        u[states.RIGHT_SOLENOID] = min(max(force, 0.0), p["maximum_solenoid_force"])
        status = advance(
            p,
            plant.table,
            plant.effects,
            plant.scale,
            k * FINE,
            FINE,
            y,
            plant.inner_step,
            u,
            plant.work,
            plant.flows,
        )
        if status != OK:
            raise PlantError(failure_text(plant, k, status))
    return ValveStep(np.arange(count) * FINE, rows[:, 0], rows[:, 1], low, high)


@dataclass(frozen=True)
class SmallStepTry:
    """One way to a faster small step, and its price.

    reaches [s]: 90 % of 5 to 15 bar for good; back [s]: of 15 to 5 bar. overshoot [Pa] upwards.
    standby [W]: leakage of both valves at rest times supply. ratio: restrictor criterion.
    large [s]: 90 % of the 100 bar step; large_overshoot [Pa].
    """

    name: str
    reaches: float
    back: float
    overshoot: float
    standby: float
    ratio: float
    large: float
    large_overshoot: float


def small_step_tries(parameters: ParameterSet) -> list[SmallStepTry]:
    """Try underlap, damping orifice and a lead on the solenoid against the source's 6 ms."""
    valve = "pressure_control_valve."
    tries = {
        "data sheet": ({}, 0.0),
        "underlap 15 um": ({valve + "underlap": 15e-6}, 0.0),
        "underlap 30 um": ({valve + "underlap": 30e-6}, 0.0),
        "damping orifice 0.12 mm": ({valve + "damping_orifice_diameter": 1.2e-4}, 0.0),
        "damping orifice 0.15 mm": ({valve + "damping_orifice_diameter": 1.5e-4}, 0.0),
        "solenoid lead 0.5 ms": ({}, 0.5e-3),
        "solenoid lead 1 ms": ({}, 1.0e-3),
        "underlap 15 um and lead 0.5 ms": ({valve + "underlap": 15e-6}, 0.5e-3),
    }
    return [_small_step(name, parameters.with_values(c), lead) for name, (c, lead) in tries.items()]


def _small_step(name: str, parameters: ParameterSet, lead: float) -> SmallStepTry:
    up = valve_step(parameters, 5e5, 15e5, lead=lead)
    down = valve_step(parameters, 15e5, 5e5, lead=lead)
    large = valve_step(parameters, 2e5, 100e5, lead=lead)
    rest = linearise(parameters, 4.9e5, flow=0.0)
    # At rest what comes from the supply leaves to the tank: K_c holds both edges' shares.
    leak = _supply_flow(parameters, rest)
    return SmallStepTry(
        name,
        up.reaches(0.9),
        down.reaches(0.9),
        up.overshoot,
        2.0 * leak * rest.supply,
        rest.restrictor_ratio,
        large.first_reaches(0.9),
        large.overshoot,
    )


def _supply_flow(parameters: ParameterSet, valve: LinearValve) -> float:
    p = valve_record(parameters)[0]
    area = edge_areas(p, valve.displacement)[0]
    drop = valve.supply - valve.pressure
    transition = float(p["laminar_transition_pressure"])
    return float(orifice_flow(float(p["orifice_constant"]) * area, drop, transition))
