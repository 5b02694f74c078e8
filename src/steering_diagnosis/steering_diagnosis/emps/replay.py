"""The axis written as one balance: M x'' = F - F_v x' - F_c sign(x') - what hypotheses add.

Inverse dynamics: position and motor force go through the same zero-phase filter, so that both
sides of the balance lose the same (parallel filtering, Gautier 1997).
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping

import numpy as np
from scipy.signal import butter, filtfilt

from steering_diagnosis.emps.data import PERIOD_S, Axis
from steering_diagnosis.engine.model import (
    Effects,
    Hypothesis,
    HypothesisParameter,
    Nuisance,
    Output,
)

CUT_OFF_HZ = 100.0
"""Of the common filter; above the engine's own, which then decides what is judged."""

PUBLISHED_HZ = 40.0
"""With this cut-off the symmetric model with an offset has the published 4.1 %."""

BALANCE = "rack force"
EDGE_SAMPLES = 200
STANDSTILL = 1e-4
"""Speed [m/s] within which a sign is rounded: at rest it would be the noise's."""

LEAST_SPEED = 5e-3
"""Below it [m/s] a sign does not say what friction does, and nothing is judged."""

Law = Callable[["Motion", Mapping[str, float]], np.ndarray]


class Motion:
    """Position, speed and acceleration, (n,) each, from the filtered position."""

    def __init__(self, axis: Axis, cut_off_hz: float) -> None:
        self.filter = butter(4, cut_off_hz, fs=1.0 / PERIOD_S)
        self.position = filtfilt(*self.filter, axis.position)
        self.speed = np.gradient(self.position, PERIOD_S)
        self.acceleration = np.gradient(self.speed, PERIOD_S)
        self.sign = np.tanh(self.speed / STANDSTILL)

    def smooth(self, values: np.ndarray) -> np.ndarray:
        """Return values through the common filter."""
        return filtfilt(*self.filter, values)


def _offset(motion: Motion, p: Mapping[str, float]) -> np.ndarray:
    return np.full(len(motion.speed), p["force"])


def _viscous_asymmetry(motion: Motion, p: Mapping[str, float]) -> np.ndarray:
    return p["difference"] * np.abs(motion.speed)


def _coulomb_asymmetry(motion: Motion, p: Mapping[str, float]) -> np.ndarray:
    return p["difference"] * np.abs(motion.sign)


def _stribeck(motion: Motion, p: Mapping[str, float]) -> np.ndarray:
    return p["breakaway"] * motion.sign * np.exp(-((motion.speed / p["speed"]) ** 2))


def _quadratic(motion: Motion, p: Mapping[str, float]) -> np.ndarray:
    return p["drag"] * motion.speed * np.abs(motion.speed)


def _position_slope(motion: Motion, p: Mapping[str, float]) -> np.ndarray:
    return p["slope"] * motion.position * motion.sign


def _spring(motion: Motion, p: Mapping[str, float]) -> np.ndarray:
    return p["stiffness"] * motion.position


LAWS: dict[str, Law] = {
    "force_offset": _offset,
    "viscous_asymmetry": _viscous_asymmetry,
    "coulomb_asymmetry": _coulomb_asymmetry,
    "stribeck_friction": _stribeck,
    "quadratic_drag": _quadratic,
    "position_dependent_friction": _position_slope,
    "position_dependent_force": _spring,
}
"""Hypothesis to the force that it adds against the motion [N]."""


def _hypothesis(name: str, summary: str, *parameters: HypothesisParameter) -> Hypothesis:
    return Hypothesis(name, summary, BALANCE, parameters)


def _parameter(
    name: str,
    unit: str,
    reach: float,
    typical: float,
    *,
    neutral: float = 0.0,
    low: float | None = None,
    shape: bool = False,
) -> HypothesisParameter:
    least = -reach if low is None else low
    return HypothesisParameter(name, unit, neutral, least, reach, typical, shape)


HYPOTHESES: dict[str, Hypothesis] = {
    made.name: made
    for made in (
        _hypothesis("force_offset", "a constant force", _parameter("force", "N", 100.0, 3.0)),
        _hypothesis(
            "viscous_asymmetry",
            "viscous friction depends on the direction of motion",
            _parameter("difference", "N s/m", 1000.0, 40.0),
        ),
        _hypothesis(
            "coulomb_asymmetry",
            "Coulomb friction depends on the direction of motion",
            _parameter("difference", "N", 100.0, 3.0),
        ),
        _hypothesis(
            "stribeck_friction",
            "friction falls as motion begins",
            _parameter("breakaway", "N", 200.0, 5.0, low=0.0),
            _parameter("speed", "m/s", 0.1, 0.01, neutral=0.01, low=1e-3, shape=True),
        ),
        _hypothesis(
            "quadratic_drag",
            "friction grows with the square of speed",
            _parameter("drag", "N s2/m2", 5000.0, 200.0),
        ),
        _hypothesis(
            "position_dependent_friction",
            "Coulomb friction changes along the screw",
            _parameter("slope", "N/m", 1000.0, 40.0),
        ),
        _hypothesis(
            "position_dependent_force",
            "a spring force along the screw",
            _parameter("stiffness", "N/m", 1000.0, 40.0),
        ),
    )
}
"""What may be wrong with the nominal model."""

NUISANCES = (
    Nuisance("mass", "kg", 95.0, 19.0),
    Nuisance("viscous_friction", "N s/m", 200.0, 100.0),
    Nuisance("coulomb_friction", "N", 20.0, 10.0),
)
"""The nominal model, known only roughly before the fit."""


class AxisReplay:
    """The axis bound to one record, as the engine takes a model."""

    outputs = (Output("force", "N", BALANCE),)
    nuisances = NUISANCES
    hypotheses: Mapping[str, Hypothesis] = HYPOTHESES
    period_s = PERIOD_S

    def __init__(self, axis: Axis, cut_off_hz: float = CUT_OFF_HZ) -> None:
        self.motion = Motion(axis, cut_off_hz)
        self.force = self.motion.smooth(axis.force)
        self.unjudged = np.abs(self.motion.speed) < LEAST_SPEED
        self.unjudged[:EDGE_SAMPLES] = self.unjudged[-EDGE_SAMPLES:] = True

    def predicted(self, nuisances: Mapping[str, float], effects: Effects) -> np.ndarray:
        """Return the motor force that the model needs for the motion [N], (n,), filtered."""
        m = self.motion
        values = {n.name: nuisances.get(n.name, n.nominal) for n in NUISANCES}
        friction = values["viscous_friction"] * m.speed + values["coulomb_friction"] * m.sign
        added = sum((LAWS[name](m, p) for name, p in effects.items()), np.zeros(len(m.speed)))
        return m.smooth(values["mass"] * m.acceleration + friction + added)

    def residuals(self, nuisances: Mapping[str, float], effects: Effects) -> np.ndarray:
        """Return measured minus predicted force [N], (n, 1); NaN at rest and the filter's ends."""
        error = self.force - self.predicted(nuisances, effects)
        error[self.unjudged] = np.nan
        return error[:, None]

    def shaken(self, nuisances: Mapping[str, float], effects: Effects) -> np.ndarray:
        """Return zeros, (n, 1): an encoder's position has hardly any noise."""
        return np.zeros((len(self.motion.position), 1))

    def noise(self) -> np.ndarray:
        """Return zero, (1,): nothing is known of the current's noise."""
        return np.zeros(1)

    def states(self) -> Mapping[str, np.ndarray]:
        """Return position, speed and acceleration, (n,)."""
        m = self.motion
        return {
            "position [m]": m.position,
            "speed [m/s]": m.speed,
            "acceleration [m/s2]": m.acceleration,
        }

    def columns(self, names: Iterable[str]) -> np.ndarray:
        """Return the force per unit of each nuisance and of each named cause, (n, k), filtered.

        Every law here is linear in its first parameter.
        """
        m = self.motion
        parts = [m.acceleration, m.speed, m.sign]
        for name in names:
            first, *others = HYPOTHESES[name].parameters
            parts.append(LAWS[name](m, {first.name: 1.0} | {p.name: p.typical for p in others}))
        inner = slice(EDGE_SAMPLES, -EDGE_SAMPLES)
        return np.stack([m.smooth(part)[inner] for part in parts], axis=1)

    def least_squares(self, names: Iterable[str]) -> np.ndarray:
        """Return the model's parameters with the named causes, by plain least squares, (k,)."""
        inner = slice(EDGE_SAMPLES, -EDGE_SAMPLES)
        solution, *_ = np.linalg.lstsq(self.columns(names), self.force[inner], rcond=None)
        return solution

    def relative_error(self, names: Iterable[str], values: np.ndarray) -> float:
        """Return the norm of the force error over the force's, as the benchmark prints it."""
        force = self.force[EDGE_SAMPLES:-EDGE_SAMPLES]
        error = force - self.columns(names) @ values
        return float(np.linalg.norm(error) / np.linalg.norm(force))
