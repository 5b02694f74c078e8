"""The axis's force balance, F = M a + Fv v + Fc sign v, and what else may act in it.

Bound to a record it implements engine.model.Replay: the residual is the motor's force less all that
resists it, both sides low-passed alike.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass

import numpy as np

from steering_diagnosis.emps.record import PERIOD_S, Axis, low_pass
from steering_diagnosis.engine.model import (
    Effects,
    Hypothesis,
    HypothesisParameter,
    Nuisance,
    Output,
)

MASS, VISCOUS, COULOMB = "mass", "viscous_friction", "coulomb_friction"
TOLERANCE = {MASS: 0.05, VISCOUS: 0.3, COULOMB: 0.2}
"""Relative, two standard deviations: a mass is well known, friction varies with the specimen."""
EDGE = 200
"""Samples at both ends that the filters disturb."""
STANDSTILL = 2e-3
"""Below this speed [m/s] Coulomb friction's direction is not known and nothing is judged."""

Force = Callable[[Axis, Mapping[str, float]], np.ndarray]


@dataclass(frozen=True)
class Suspect:
    """A hypothesis with the force that it adds [N], (n,)."""

    hypothesis: Hypothesis
    force: Force


def _suspect(name: str, summary: str, force: Force, *parameters: HypothesisParameter) -> Suspect:
    return Suspect(Hypothesis(name, summary, "axis force", parameters), force)


def _size(unit: str, typical: float, low: float | None = None) -> HypothesisParameter:
    reach = 20.0 * typical
    return HypothesisParameter("size", unit, 0.0, -reach if low is None else low, reach, typical)


def _direction(axis: Axis) -> np.ndarray:
    return np.sign(axis.speed)


SUSPECTS = {
    s.hypothesis.name: s
    for s in (
        _suspect(
            "viscous_asymmetry",
            "viscous friction depends on the direction (a worn screw)",
            lambda a, p: p["size"] * np.abs(a.speed),
            _size("N s/m", 30.0),
        ),
        _suspect(
            "coulomb_asymmetry",
            "Coulomb friction depends on the direction",
            lambda a, p: p["size"] * np.abs(_direction(a)),
            _size("N", 3.0),
        ),
        _suspect(
            "constant_offset",
            "a constant force, or an offset of the drive's current",
            lambda a, p: np.full(len(a.speed), p["size"]),
            _size("N", 3.0),
        ),
        _suspect(
            "stribeck_friction",
            "friction rises towards standstill",
            lambda a, p: p["size"] * np.exp(-((a.speed / p["speed"]) ** 2)) * _direction(a),
            _size("N", 4.0, 0.0),
            HypothesisParameter("speed", "m/s", 0.01, 0.001, 0.1, 0.01, shape=True),
        ),
        _suspect(
            "position_dependent_friction",
            "friction changes along the screw",
            lambda a, p: p["size"] * (a.position - a.position.mean()) * _direction(a),
            _size("N/m", 20.0),
        ),
        _suspect(
            "quadratic_friction",
            "friction grows with the square of the speed",
            lambda a, p: p["size"] * a.speed * np.abs(a.speed),
            _size("N s2/m2", 400.0),
        ),
        _suspect(
            "position_dependent_force",
            "a force along the travel, as of a cable",
            lambda a, p: p["size"] * (a.position - a.position.mean()),
            _size("N/m", 20.0),
        ),
    )
}


def nominal(axis: Axis) -> dict[str, float]:
    """Return mass and symmetric friction by least squares: the nominal model has no data sheet."""
    inner = slice(EDGE, -EDGE)
    columns = [axis.acceleration, axis.speed, low_pass(_direction(axis))]
    found = np.linalg.lstsq(np.stack(columns, axis=-1)[inner], axis.force[inner], rcond=None)[0]
    return dict(zip((MASS, VISCOUS, COULOMB), map(float, found), strict=True))


class AxisReplay:
    """The nominal axis bound to a record. nominal: mass and friction, see ``nominal``."""

    period_s = PERIOD_S
    outputs = (Output("motor_force", "N", "axis force"),)

    def __init__(self, axis: Axis, nominal: Mapping[str, float]) -> None:
        self.axis = axis
        self.nominal = dict(nominal)
        self.nuisances = tuple(
            Nuisance(n, u, nominal[n], TOLERANCE[n] * abs(nominal[n]))
            for n, u in ((MASS, "kg"), (VISCOUS, "N s/m"), (COULOMB, "N"))
        )
        self.hypotheses: Mapping[str, Hypothesis] = {n: s.hypothesis for n, s in SUSPECTS.items()}
        self._direction = low_pass(_direction(axis))

    def residuals(self, nuisances: Mapping[str, float], effects: Effects) -> np.ndarray:
        """Return the motor's force less what resists it [N], (n, 1); NaN near standstill."""
        error = self.error(nuisances, effects)
        error[np.abs(self.axis.speed) < STANDSTILL] = np.nan
        return error[:, None]

    def error(self, nuisances: Mapping[str, float], effects: Effects) -> np.ndarray:
        """Return the motor's force less what resists it [N], (n,), standstill included."""
        p, axis = {**self.nominal, **nuisances}, self.axis
        resisting = p[MASS] * axis.acceleration + p[VISCOUS] * axis.speed
        resisting = resisting + p[COULOMB] * self._direction
        for name, values in effects.items():
            resisting = resisting + low_pass(SUSPECTS[name].force(axis, values))
        error = axis.force - resisting
        error[:EDGE] = error[-EDGE:] = np.nan
        return error

    def states(self) -> Mapping[str, np.ndarray]:
        """Return what a free-form term may depend on, name [unit] to (n,)."""
        axis = self.axis
        return {
            "position [m]": axis.position,
            "speed [m/s]": axis.speed,
            "acceleration [m/s2]": axis.acceleration,
        }
