"""The chosen valve's behaviour: static characteristics in both directions, and steps."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from pressure_control.linear_valve import linearise
from pressure_control.valve_design.front import Front
from pressure_control.valve_design.problem import (
    BAR,
    LITRE_MINUTE,
    STEP_H,
    VARIABLES,
    run,
)
from pressure_control.valve_diagram import simplified_loop_gain
from pressure_control.valve_static import pressure_under_flow
from steering_core.parameters import ParameterSet
from steering_plant.plant import plant_record

REFERENCES_BAR = (5.0, 20.0, 40.0, 60.0, 80.0, 100.0)
FLOWS = np.linspace(-5.0, 5.0, 81) * LITRE_MINUTE
STEPS_BAR = ((0.0, 100.0), (5.0, 15.0), (15.0, 5.0))
STEP_S = 0.03
QUICK_S = 5e-3


@dataclass(frozen=True)
class Characteristic:
    """Pressure [Pa] over the flow out of the chamber [m3/s], (n,), at one reference [Pa]."""

    reference: float
    flow: np.ndarray
    pressure: np.ndarray


@dataclass(frozen=True)
class Step:
    """Pressure [Pa] over time [s], (n,), after a step of the reference, without load flow."""

    start: float
    reference: float
    time: np.ndarray
    pressure: np.ndarray

    def time_to(self, share: float) -> float:
        """Return the time [s] after which ``share`` of the step is done; NaN if never."""
        done = (self.pressure - self.start) / (self.reference - self.start)
        reached = np.flatnonzero(done >= share)
        return float(self.time[reached[0]]) if len(reached) else float("nan")

    @property
    def overshoot(self) -> float:
        """Return by how much the pressure goes beyond the reference [Pa]."""
        sign = np.sign(self.reference - self.start)
        return float(np.max(sign * (self.pressure - self.reference)))


def nominal_design(parameters: ParameterSet) -> np.ndarray:
    """Return the data sheet's valve as a design, shape (4,), in the variables' order."""
    group = parameters.group("pressure_control_valve")
    return np.array([group[name] for name in VARIABLES])


def chosen_design(front: Front) -> np.ndarray:
    """Return the front's design of least force that makes the large step within 5 ms.

    That is what the source asks of its own choice (fig 6.7); without one, the quickest design.
    """
    quick = np.flatnonzero(front.step_times <= QUICK_S)
    return front.designs[quick[np.argmin(front.forces[quick])] if len(quick) else 0]


def characteristics(parameters: ParameterSet) -> list[Characteristic]:
    """Return the valve's static characteristics in both directions, no controller (fig 6.5)."""
    return [
        Characteristic(bar * BAR, FLOWS, pressure_under_flow(parameters, bar * BAR, FLOWS))
        for bar in REFERENCES_BAR
    ]


@dataclass(frozen=True)
class Stability:
    """The loop gain's margins where the gain is highest: pressure [Pa], flow [m3/s], K_v, deg."""

    pressure: float
    flow: float
    gain: float
    phase_margin: float


def stability(parameters: ParameterSet) -> Stability:
    """Return the phase margin of 5.30 at the operating point of the highest gain (fig 6.6)."""
    points = [
        (linearise(parameters, bar * BAR, flow=flow), bar * BAR, flow)
        for bar in (2.0, 5.0, 10.0, 20.0, 50.0, 100.0, 150.0)
        for flow in np.array([-2.0, -0.5, -0.05, 0.0, 0.05, 0.5, 2.0]) * LITRE_MINUTE
    ]
    valve, pressure, flow = max(points, key=lambda point: point[0].loop_gain)
    omega = np.logspace(0, 6, 4000)
    loop = simplified_loop_gain(valve, 1j * omega)
    beyond = np.flatnonzero(np.abs(loop) < 1.0)
    phase = np.degrees(np.unwrap(np.angle(loop)))
    margin = 180.0 + float(phase[beyond[0]]) if len(beyond) else float("nan")
    return Stability(pressure, flow, valve.loop_gain, margin)


def steps(parameters: ParameterSet) -> list[Step]:
    """Return the step responses of fig 6.7, large and small, without load flow."""
    par = plant_record(parameters, "closed_centre")
    made = []
    for start, reference in STEPS_BAR:
        pressure = run(par, start * BAR, reference * BAR, 0.0, STEP_S)[:, 0]
        time = np.arange(len(pressure)) * STEP_H
        made.append(Step(start * BAR, reference * BAR, time, pressure))
    return made


@dataclass(frozen=True)
class Behaviour:
    """What the page shows of one valve."""

    stability: Stability
    characteristics: list[Characteristic]
    steps: list[Step]


def behaviour(parameters: ParameterSet) -> Behaviour:
    """Return stability, static characteristics and steps of a parameter set's valve."""
    return Behaviour(stability(parameters), characteristics(parameters), steps(parameters))
