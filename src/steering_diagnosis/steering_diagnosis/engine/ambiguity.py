"""Rivals that the record cannot tell from a cause (Vuong 1989, on blocks)."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from steering_diagnosis.engine.fit import Fit, Problem
from steering_diagnosis.engine.noise import Noise, usable

MOST = 3
EQUAL = 6.0
"""Difference in misfit within which two models are equally good whatever the blocks say."""


@dataclass(frozen=True)
class Comparison:
    """A rival against the best. excess: of its misfit. sigmas: the same over its standard error."""

    rival: str
    excess: float
    sigmas: float
    cosine: float


def compare(problem: Problem, best: Fit, other: Fit, cause: str, block: np.ndarray) -> Comparison:
    """Compare the model with a rival in the place of ``cause`` to the best model.

    Each with its own noise, and both with either's: a rival that leaves a slow error is not as good
    because coloured noise takes it up.
    """
    (rival,) = other.names - best.names
    own = block_scores(problem, other, block) - block_scores(problem, best, block)
    excess = other.misfit - best.misfit
    common = _in_either_noise(problem, best, other, block)
    more = float(common.sum())
    sigmas = max(float(excess / _spread(own)), float(more / _spread(common)))
    return Comparison(rival, max(excess, more), sigmas, cosine(problem, best, other))


def block_scores(problem: Problem, fit: Fit, block: np.ndarray) -> np.ndarray:
    """Return minus twice the log-likelihood of each block of the whole record, (blocks,)."""
    rows = usable(problem.valid, fit.noise.order)
    white = fit.noise.whiten(fit.residual)
    each = np.where(rows, white**2 + np.log(fit.noise.sd**2), 0.0).sum(axis=1)
    return np.bincount(block, each) * problem.runs.grid.density


def ahead(problem: Problem, one: Fit, other: Fit) -> float:
    """Return how much smaller a model's misfit is than another's, in either's noise at least."""
    whole = np.zeros(len(one.residual), int)
    return float(_in_either_noise(problem, one, other, whole).sum())


def _in_either_noise(problem: Problem, best: Fit, other: Fit, block: np.ndarray) -> np.ndarray:
    """Return by how much a rival's misfit is larger, in the noise that suits it, (blocks,)."""
    found = [_in_one_noise(problem, best, other, n, block) for n in (best.noise, other.noise)]
    return min(found, key=np.sum)


def _in_one_noise(
    problem: Problem, best: Fit, other: Fit, noise: Noise, block: np.ndarray
) -> np.ndarray:
    """Return by how much the rival's misfit is larger where both have one noise, (blocks,)."""
    rows = usable(problem.valid, noise.order)
    apart = noise.whiten(other.residual) ** 2 - noise.whiten(best.residual) ** 2
    return np.bincount(block, np.where(rows, apart, 0.0).sum(axis=1)) * problem.runs.grid.density


def _spread(difference: np.ndarray) -> float:
    """Return the standard error of a sum over blocks."""
    return float(np.sqrt(len(difference)) * difference.std(ddof=1)) + 1e-9


def cosine(problem: Problem, best: Fit, other: Fit) -> float:
    """Return how alike two models' corrections are: of what each removes beyond the shared part."""
    weights = problem.weights()
    a = best.noise.whiten(best.residual) * weights
    b = best.noise.whiten(other.residual) * weights
    return float(1.0 - np.linalg.norm(a - b) / (np.linalg.norm(a) + np.linalg.norm(b) + 1e-300))


def as_good(found: list[Comparison], sigmas: float) -> list[Comparison]:
    """Return the rivals that are as good as the best, best first, at most two."""
    equal = [c for c in found if c.excess < EQUAL or c.sigmas < sigmas]
    return sorted(equal, key=lambda c: c.excess)[: MOST - 1]
