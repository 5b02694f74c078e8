"""Weighted least squares within bounds."""

from __future__ import annotations

import numpy as np
from scipy.optimize import lsq_linear

from steering_diagnosis.engine.failures import CandidateError
from steering_diagnosis.engine.kernels.gram import gram as gram_kernel

ROUNDED = 1e-12
"""By how much the bounds of a step are wider than a parameter's, so that they never meet."""


def gram_of(columns: np.ndarray, weights: np.ndarray) -> np.ndarray:
    """Return the weighted gram matrix of columns (n, outputs, k); weights: (n, outputs)."""
    k = columns.shape[-1]
    lower = np.zeros((k, k))
    gram_kernel(np.ascontiguousarray(columns).reshape(-1, k), weights.ravel(), lower)
    return lower + np.tril(lower, -1).T


def bounded(gram: np.ndarray, slope: np.ndarray, low: np.ndarray, high: np.ndarray) -> np.ndarray:
    """Minimise x' G x - 2 b' x within bounds. CandidateError: they hold what is no number."""
    if not (np.isfinite(gram).all() and np.isfinite(slope).all()):
        raise CandidateError("its equations hold what is no number")
    ridge = 1e-9 * max(float(np.trace(gram)) / max(len(gram), 1), 1e-300)
    root = np.linalg.cholesky(gram + ridge * np.eye(len(gram)))
    target = np.linalg.solve(root, slope)
    free = np.linalg.solve(root.T, target)
    if np.all(free >= low) and np.all(free <= high):
        return free
    return lsq_linear(root.T, target, (low, high), method="bvls").x
