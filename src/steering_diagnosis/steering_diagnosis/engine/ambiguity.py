"""Rivals that the record cannot tell from a cause (Vuong 1989, on blocks)."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from steering_diagnosis.engine.evidence import certainty
from steering_diagnosis.engine.fit import Fit, Problem
from steering_diagnosis.engine.noise import usable

MOST = 3
EQUAL = 6.0
"""Difference in misfit within which two models are equally good whatever the blocks say."""


@dataclass(frozen=True)
class Comparison:
    """A rival against the best. excess: of its misfit. sigmas: the same over its standard error."""

    rival: str
    excess: float
    sigmas: float


def compare(problem: Problem, best: Fit, other: Fit, cause: str, block: np.ndarray) -> Comparison:
    """Compare the model with a rival in the place of ``cause`` to the best model."""
    (rival,) = other.names - best.names
    apart = block_scores(problem, other, block) - block_scores(problem, best, block)
    excess = other.misfit - best.misfit
    return Comparison(rival, excess, certainty(apart))


def block_scores(problem: Problem, fit: Fit, block: np.ndarray) -> np.ndarray:
    """Return the misfit of each block of the whole record, (blocks,)."""
    rows = usable(problem.valid, fit.noise.order)
    white = fit.noise.whiten(fit.residual)
    each = np.where(rows, white**2, 0.0).sum(axis=1)
    return np.bincount(block, each) * problem.runs.grid.density


def as_good(found: list[Comparison], sigmas: float) -> list[Comparison]:
    """Return the rivals that are as good as the best, best first, at most two."""
    equal = [c for c in found if c.excess < EQUAL or c.sigmas < sigmas]
    return sorted(equal, key=lambda c: c.excess)[: MOST - 1]
