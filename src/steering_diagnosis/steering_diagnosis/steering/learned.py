"""What a record tells of the gear's toleranced parameters, as a distribution for a fleet."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from steering_diagnosis.engine.catalogue import PREFIX
from steering_diagnosis.engine.findings import Findings
from steering_diagnosis.report import Learned
from steering_diagnosis.steering.full_model import full_model
from steering_diagnosis.steering.replay import SteeringReplay

STEP = 1e-3
"""Of the differences with respect to an effect's parameter, relative to it or to one."""


def learned(replay: SteeringReplay, findings: Findings) -> Learned:
    """Return the posterior of every toleranced parameter, under its tolerance as prior.

    What a named effect makes of a parameter counts: a bar that an effect has made stiffer is stiff.
    An effect's own size has no prior; the parameter that it changes is given its tolerance.
    """
    known = findings.catalogue
    values = _changed(replay, findings.nuisances, findings.effects)
    deviation = np.array([0.5 * n.tolerance for n in known])
    mean = (values - np.array([n.nominal for n in known])) / deviation
    turned = np.eye(len(known), len(known) + len(findings.active))
    for j, (effect, parameter) in enumerate(findings.active):
        turned[:, len(known) + j] = _slope(replay, findings, effect, parameter) / deviation
    mean = mean + turned @ findings.step
    cov = turned @ findings.spread @ turned.T
    told = np.any(turned[:, len(known) :] != 0.0, axis=1)
    if told.any():
        precision = np.linalg.pinv(cov, hermitian=True)
        slope = precision @ mean
        cov = np.linalg.inv(precision + np.diag(told.astype(float)))
        mean = cov @ slope
    by = {n.name: _by(replay, findings, n.name) for n, t in zip(known, told, strict=True) if t}
    return Learned(
        names=[n.name for n in known],
        nominal=[n.nominal for n in known],
        deviation=deviation.tolist(),
        mean=mean.tolist(),
        covariance=[[float(f"{x:.6g}") for x in row] for row in cov],
        changed_by={name: effects for name, effects in by.items() if effects},
    )


def _changed(
    replay: SteeringReplay,
    nuisances: Mapping[str, float],
    effects: Mapping[str, Mapping[str, float]],
) -> np.ndarray:
    """Return the toleranced parameters as effects have them, (p,)."""
    parameters = replay.record.nominal.with_values(nuisances)
    changed = full_model(replay.record.valve_system).changed(parameters, effects)
    return np.array([changed[n.name] for n in replay.nuisances if n.tolerance > 0.0])


def _slope(replay: SteeringReplay, findings: Findings, effect: str, parameter: str) -> np.ndarray:
    """Return how the toleranced parameters change with one of an effect, (p,)."""
    if effect.startswith(PREFIX):
        return np.array([float(n.name == parameter) for n in findings.catalogue])
    given = findings.effects[effect]
    step = STEP * max(abs(given[parameter]), 1.0)
    moved = {**findings.effects, effect: {**given, parameter: given[parameter] + step}}
    more = _changed(replay, findings.nuisances, moved)
    less = _changed(replay, findings.nuisances, findings.effects)
    return (more - less) / step


def _by(replay: SteeringReplay, findings: Findings, name: str) -> list[str]:
    """Return the named effects that change a parameter."""
    at = [n.name for n in findings.catalogue].index(name)
    return sorted({e for e, p in findings.active if _slope(replay, findings, e, p)[at] != 0.0})
