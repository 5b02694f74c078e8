"""Intervals of the estimated parameters: block sandwich, prior of the nuisances, form of the law.

The sandwich over blocks stays honest where what remains is coloured or not quite the model's
(White 1982; Künsch 1989 on blocks). It is never taken smaller than the likelihood's own covariance.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy import stats

from steering_diagnosis.engine.catalogue import bounds, scales
from steering_diagnosis.engine.equations import gram_of
from steering_diagnosis.engine.fit import Fit, Problem, fixed_sizes, normal_equations
from steering_diagnosis.engine.screen import active_columns

FIXED = 1e6
"""Weight of a parameter that stays where it is, over all others together."""


@dataclass(frozen=True)
class Interval:
    """An estimate with its 95 % interval [unit]."""

    value: float
    low: float
    high: float
    unit: str


@dataclass(frozen=True, repr=False)
class Covariance:
    """Covariance of nuisances [standard deviations] and hypotheses [typical sizes].

    matrix: likelihood's, with the prior. blocks: influence of each block, (blocks, p + k).
    """

    matrix: np.ndarray
    blocks: np.ndarray

    def deviation(self, index: int) -> tuple[float, int]:
        """Return the standard deviation of one coordinate, and its degrees of freedom."""
        count = len(self.blocks)
        spread = self.blocks[:, index] - self.blocks[:, index].mean()
        sandwich = count / max(count - 1, 1) * float(spread @ spread)
        return float(np.sqrt(max(sandwich, self.matrix[index, index]))), max(count - 1, 1)


def covariance(problem: Problem, fit: Fit, block: np.ndarray) -> Covariance:
    """Return the covariance at a fit. block: number of each sample, (n,); empty: no sandwich."""
    columns = np.concatenate([problem.nuisance, active_columns(fit)], axis=-1)
    weights = problem.weights()
    c = fit.noise.whiten(columns)
    gram = gram_of(c, weights**2)
    p = problem.nuisance.shape[-1]
    gram[np.arange(p), np.arange(p)] += 1.0
    fixed = [fixed_sizes(problem, n, len(v)) for n, v in fit.values.items()]
    sizes = p + np.flatnonzero(np.concatenate([np.zeros(0, bool), *fixed]))
    at = [*problem.book.replaced(fit.values), *sizes]
    gram[at, at] += FIXED * np.trace(gram)
    matrix = np.linalg.pinv(gram, hermitian=True)
    if not len(block):
        return Covariance(matrix, np.zeros((0, len(matrix))))
    e = fit.noise.whiten(fit.residual) * weights**2
    each = np.einsum("nmk,nm->nk", c, e)
    used = np.unique(block[weights.any(axis=1)])
    slopes = np.stack([each[block == b].sum(axis=0) for b in used])
    return Covariance(matrix, slopes @ matrix)


def posterior(problem: Problem, fit: Fit) -> tuple[np.ndarray, np.ndarray]:
    """Return the step to the mean, (p + k,), and the covariance of nuisances and hypotheses.

    Nuisances in standard deviations, hypotheses in their units; with the tolerances as prior, but
    without the ends at which the fit holds nuisances: whoever averages needs the unbounded mean.
    """
    units = [scales(problem.book.hypotheses[name]) for name in fit.values]
    p = problem.nuisance.shape[-1]
    unit = np.concatenate([np.ones(p), *units])
    matrix = covariance(problem, fit, np.zeros(0)).matrix
    columns = np.concatenate([problem.nuisance, active_columns(fit)], axis=-1)
    _, slope, _ = normal_equations(problem, fit, columns)
    slope[:p] -= fit.z
    return matrix @ slope * unit, matrix * np.outer(unit, unit)


def intervals(problem: Problem, fit: Fit, block: np.ndarray) -> dict[str, dict[str, Interval]]:
    """Return the estimates of every active hypothesis with their 95 % intervals."""
    spread = covariance(problem, fit, block)
    at = problem.nuisance.shape[-1]
    found: dict[str, dict[str, Interval]] = {}
    for name, value in fit.values.items():
        h = problem.book.hypotheses[name]
        low, high = bounds(h)
        found[name] = {}
        for i, (p, size) in enumerate(zip(h.parameters, scales(h), strict=True)):
            sd, freedom = spread.deviation(at)
            sd = float(
                np.hypot(sd * size, problem.settings.form_uncertainty * (value[i] - p.neutral))
            )
            half = float(stats.t.ppf(0.975, freedom)) * sd
            turned = p.turned(value[i])
            found[name][p.name] = Interval(
                float(value[i] - turned),
                float(max(value[i] - half, low[i]) - turned),
                float(min(value[i] + half, high[i]) - turned),
                p.unit,
            )
            at += 1
    return found
