"""Intervals of the numbers of a fit: likelihood and blocks, whichever is wider.

The block sandwich stays honest where what is left is coloured (White 1982; Kuensch 1989).
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy import stats

from balance_diagnosis.evidence import Criterion, Fit

BLOCKS = 20


@dataclass(frozen=True)
class Estimate:
    """A number with its 95 % interval, within its bounds.

    cause: whose it is, "" for a parameter or a start. record: whose start it is, "" for others.
    """

    name: str
    cause: str
    value: float
    low: float
    high: float
    record: str = ""

    def __str__(self) -> str:
        return f"{self.value:.4g}, 95 % within {self.low:.4g} to {self.high:.4g}"


def estimates(criterion: Criterion, fit: Fit) -> list[Estimate]:
    """Return every coordinate of a fit as a number with its interval."""
    problem = criterion.problem
    slots, covariance = problem.slots(fit.names), _covariance(criterion, fit)
    factor = float(stats.t.ppf(0.975, BLOCKS - 1))
    made = []
    for i, slot in enumerate(slots):
        half = factor * float(np.sqrt(max(covariance[i, i], 0.0)))
        record = "" if slot.record is None else problem.records[slot.record].name
        value, low, high = (slot.prior.value(float(fit.x[i]) + d) for d in (0.0, -half, half))
        made.append(Estimate(slot.name, slot.cause, value, low, high, record))
    return made


def _covariance(criterion: Criterion, fit: Fit) -> np.ndarray:
    """Return the covariance of all coordinates: the larger deviation of the two, one by one."""
    weighted = fit.columns.T * fit.weights
    likelihood = np.linalg.inv(weighted @ fit.columns + np.eye(len(fit.whole)))
    slopes = []
    for span in criterion.problem.spans:
        parts = np.array_split(np.arange(span.start, span.stop), BLOCKS)
        slopes += [weighted[:, rows] @ fit.residual[rows] for rows in parts if len(rows)]
    influence = np.array(slopes) @ likelihood
    influence = influence - influence.mean(axis=0)
    sandwich = influence.T @ influence * len(influence) / max(len(influence) - 1, 1)
    wider = np.sqrt(np.maximum(np.diag(sandwich) / np.diag(likelihood), 1.0))
    return likelihood * np.outer(wider, wider)
