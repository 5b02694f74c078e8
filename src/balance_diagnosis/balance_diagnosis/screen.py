"""Screening: what each cause would gain, linear about a fit, and where its refits begin."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from balance_diagnosis.evidence import Criterion, Fit, limits
from balance_diagnosis.problem import Problem

FARTHEST = 8.0
"""Multiples of a trial to which a linear cause is led at once."""

NEAR = (0.3, 1.5)
"""The same of one that is not linear: a stop or a gap is far from its change at twice the size."""


@dataclass(frozen=True, repr=False)
class Trial:
    """A cause at some numbers: what it changes in the residuals, (rows,)."""

    cause: str
    numbers: dict[str, float]
    change: np.ndarray


@dataclass(frozen=True)
class Score:
    """gain: linear, in nats. factor: of the trial's sizes at which it is reached. information:
    expected from a cause at this trial's numbers, in nats, beside all parameters."""

    cause: str
    gain: float
    numbers: dict[str, float]
    factor: float
    information: float


def trials(problem: Problem, fit: Fit, causes: Sequence[str], typical: bool = False) -> list[Trial]:
    """Return the changes of causes about a fit. typical: only at their typical numbers."""
    base = problem.residual(fit.names, fit.x)
    found: list[Trial] = []
    if base is None:
        return found
    for cause in causes:
        known = problem.probed[cause].trials
        for numbers in known[:1] if typical else known:
            made = problem.residual(fit.names, fit.x, numbers)
            if made is not None:
                found.append(Trial(cause, numbers, made - base))
    return found


def scores(criterion: Criterion, fit: Fit, tried: Sequence[Trial]) -> dict[str, list[Score]]:
    """Return what each cause would gain beside refitted coordinates, best trials first."""
    made: dict[str, list[Score]] = {}
    if not tried:
        return made
    roots = np.sqrt(fit.weights)
    columns, residual = (fit.columns.T * roots).T, fit.residual * roots
    changes = np.stack([t.change for t in tried], axis=1)
    changes = (changes.T / criterion.noise.sd * roots).T
    lower = np.linalg.cholesky(columns.T @ columns + np.eye(columns.shape[1]))
    seen = np.linalg.solve(lower, columns.T @ changes)
    known = np.linalg.solve(lower, columns.T @ residual)
    energy = np.maximum((changes**2).sum(axis=0) - (seen**2).sum(axis=0), 0.0)
    slope = changes.T @ residual - seen.T @ known
    for i, trial in enumerate(tried):
        linear = criterion.problem.probed[trial.cause].linear
        low, high = (-FARTHEST, FARTHEST) if linear else NEAR
        factor = float(np.clip(-slope[i] / (energy[i] + 1e-12), low, high))
        gain = float(-(slope[i] * factor + 0.5 * energy[i] * factor**2))
        score = Score(trial.cause, gain, trial.numbers, factor, float(0.5 * energy[i]))
        made.setdefault(trial.cause, []).append(score)
    return {cause: sorted(s, key=lambda v: -v.gain) for cause, s in made.items()}


def start_with(
    problem: Problem, fit: Fit, cause: str, numbers: dict[str, float], factor: float = 1.0
) -> tuple[tuple[str, ...], np.ndarray]:
    """Return the names and the coordinates of a fit with one more cause, at a trial's numbers."""
    names = (*fit.names, cause)
    probed = problem.probed[cause]
    offs = {n.name: n.off for n in probed.cause.numbers}
    places = []
    for name, prior in probed.priors.items():
        value = numbers[name]
        if name in probed.sizes:
            value = offs[name] + factor * (value - offs[name])
        places.append(prior.place(min(max(value, prior.low), prior.high)))
    return names, inside(problem, names, np.r_[fit.x, places])


def start_without(problem: Problem, fit: Fit, cause: str) -> tuple[tuple[str, ...], np.ndarray]:
    """Return the names and the coordinates of a fit that lacks one of its causes."""
    kept = [slot.cause != cause for slot in problem.slots(fit.names)]
    return tuple(n for n in fit.names if n != cause), fit.x[kept]


def inside(problem: Problem, names: Sequence[str], x: np.ndarray) -> np.ndarray:
    """Return coordinates a little inside of their bounds, where a slope of zero could hold them."""
    low, high = limits(problem, names)
    return np.clip(x, low + 1e-3, high - 1e-3)
