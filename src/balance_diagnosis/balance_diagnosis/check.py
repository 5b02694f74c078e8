"""The check: whether what the best model leaves has a form that the catalogue lacks.

s = (share of the nominal error that is left) x (share of it that smooth functions of states predict
in blocks that took no part in their fit).
"""

from __future__ import annotations

import numpy as np

from balance_diagnosis.evidence import Criterion, Fit
from balance_diagnosis.noise import Scenery

BLOCKS, FOLDS = 20, 5
RIDGES = 10.0 ** np.arange(-2.0, 4.0)


def predicted_share(criterion: Criterion, scenery: Scenery, fit: Fit) -> float:
    """Return the share of a fit's residual that smooth functions predict in blocks left out."""
    total = found = 0.0
    for i, span in enumerate(criterion.problem.spans):
        rest = fit.residual[span]
        total += float(rest @ rest)
        found += _predicted(rest, scenery.smooth[i])
    return found / total if total > 0.0 else 0.0


def _predicted(rest: np.ndarray, functions: np.ndarray) -> float:
    """Return the energy that is predicted, at the ridge that predicts most; none is zero."""
    fold = np.arange(len(rest)) * BLOCKS // len(rest) % FOLDS
    columns = np.concatenate([np.ones((len(rest), 1)), functions], axis=1)
    missed = np.zeros(len(RIDGES))
    for number in range(FOLDS):
        out = fold == number
        fitted, judged = columns[~out], columns[out]
        gram, product = fitted.T @ fitted, fitted.T @ rest[~out]
        for k, ridge in enumerate(RIDGES):
            weights = np.linalg.solve(gram + ridge * np.eye(len(gram)), product)
            missed[k] += float(((rest[out] - judged @ weights) ** 2).sum())
    return max(float(rest @ rest) - float(missed.min()), 0.0)


def not_noise(criterion: Criterion, fit: Fit) -> float:
    """Return the probability that what is left is more than noise.

    K directions of a common variance against none at all, the scale's cost in the manner of BIC.
    """
    facts = criterion.noise.facts
    gain = 0.5 * fit.excess.sum() - 0.5 * float(facts @ np.log1p(fit.excess / facts))
    return float(1.0 / (1.0 + np.exp(-np.clip(gain - 0.5 * np.log(facts.sum()), -500.0, 500.0))))
