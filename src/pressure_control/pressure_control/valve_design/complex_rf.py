"""The Complex-RF method: a simplex of more points than it needs, with noise and forgetting.

M. J. Box, A new method of constrained optimization and a comparison with other methods, The
Computer Journal 8 (1965); randomisation and forgetting by P. Krus and J. Andersson, Optimizing
optimization for design optimization, ASME DETC (2003).
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

REFLECTION = 1.3
NOISE, FORGETTING = 0.3, 0.3
"""Randomisation and forgetting factor, each between 0 (Box's method) and 1."""

MOST_RETRACTIONS = 12


@dataclass(frozen=True)
class Optimum:
    """Best point, its objective, and the number of evaluations."""

    point: np.ndarray
    value: float
    evaluations: int


def complex_rf(
    objective: Callable[[np.ndarray], float],
    lower: np.ndarray,
    upper: np.ndarray,
    random: np.random.Generator,
    *,
    most_evaluations: int = 400,
    spread: float = 1e-3,
) -> Optimum:
    """Return the least ``objective`` between the bounds, (n,) each.

    The complex has 2 n points. The worst is reflected through the centre of the others by 1.3
    times its distance, with noise in proportion to the complex's spread. While it stays the worst,
    it is drawn towards centre and best point. Each step all values are made a little worse, so that
    an old lucky one does not hold the search. Ends when the complex is smaller than ``spread`` of
    the bounds, or after ``most_evaluations``.
    """
    size = len(lower)
    count = 2 * size
    points = lower + random.random((count, size)) * (upper - lower)
    values = np.array([objective(point) for point in points])
    true = values.copy()
    best_point, best = points[np.argmin(true)].copy(), float(true.min())
    spent = count
    forget = 1.0 - (REFLECTION / 2.0) ** (FORGETTING / count)
    while spent < most_evaluations:
        width = float(np.max(np.ptp(points, axis=0) / (upper - lower)))
        if width < spread:
            break
        worst = int(np.argmax(values))
        centre = np.delete(points, worst, axis=0).mean(axis=0)
        trial = centre + REFLECTION * (centre - points[worst])
        for retraction in range(MOST_RETRACTIONS):
            noise = NOISE * width * (upper - lower) * (random.random(size) - 0.5)
            trial = np.clip(trial + noise, lower, upper)
            value = objective(trial)
            spent += 1
            others = np.delete(values, worst)
            if value < others.max() or spent >= most_evaluations:
                break
            # Early towards the centre, later towards the best point.
            share = (count / (count + retraction)) ** ((count + retraction) / count)
            aim = share * centre + (1.0 - share) * points[np.argmin(values)]
            trial = 0.5 * (trial + aim)
        points[worst], values[worst] = trial, value
        if value < best:
            best_point, best = trial.copy(), float(value)
        values = values + forget * (values.max() - values.min())
    return Optimum(best_point, best, spent)
