"""Exact sampling of a linear system whose input runs straight from tick to tick."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

# Taylor terms of exp(M) for a norm of at most 1/2: the first one left out is below 1e-19.
TAYLOR_TERMS = 16


class Sampled(NamedTuple):
    """z(k+1) = transition z(k) + held x(k) + slope (x(k+1) - x(k)). Shapes (n, n), (n,), (n,)."""

    transition: np.ndarray
    held: np.ndarray
    slope: np.ndarray


def exponential(matrix: np.ndarray) -> np.ndarray:
    """Return exp(``matrix``) by scaling and squaring of its Taylor series."""
    norm = float(np.abs(matrix).sum(axis=0).max())
    squarings = max(0, int(np.ceil(np.log2(norm))) + 1) if norm > 0.0 else 0
    scaled = matrix / 2.0**squarings
    result = term = np.eye(matrix.shape[0])
    for order in range(1, TAYLOR_TERMS + 1):
        term = term @ scaled / order
        result = result + term
    for _ in range(squarings):
        result = result @ result
    return result


def first_order_hold(a_matrix: np.ndarray, b_vector: np.ndarray, period: float) -> Sampled:
    """Return z' = A z + B x sampled every ``period`` [s], exact for x linear in between.

    The input and its rise over the period are appended to the state; one exponential then gives
    all three parts, also where A has no inverse.
    """
    n = b_vector.size
    extended = np.zeros((n + 2, n + 2))
    extended[:n, :n] = a_matrix * period
    extended[:n, n] = b_vector * period
    extended[n, n + 1] = 1.0
    solved = exponential(extended)
    return Sampled(solved[:n, :n], solved[:n, n], solved[:n, n + 1])
