"""Smooth functions of the states: what structure without a name may depend on."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from scipy.interpolate import BSpline

KNOTS = 7
LAGS = (1, 2, 4, 8)
DEGREE = 2
MOST_PAIRS = 20


@dataclass(frozen=True, repr=False)
class Basis:
    """Columns (n, k), and the state that each is of ('' for products and lags)."""

    columns: np.ndarray
    owner: tuple[str, ...]


def basis(states: Mapping[str, np.ndarray]) -> Basis:
    """Return splines in each state, lagged states, and products of two."""
    columns: list[np.ndarray] = []
    owner: list[str] = []
    scaled = {}
    for name, x in states.items():
        x = np.nan_to_num(x)
        if np.ptp(x) <= 1e-12 * (np.abs(x).max() + 1e-300):
            continue
        scaled[name] = (x - x.mean()) / x.std()
        spline = splines(x, knots(x))
        columns += list(spline.T)
        owner += [name] * spline.shape[1]
        for lag in LAGS:
            columns.append(np.r_[np.zeros(lag), scaled[name][lag:] - scaled[name][:-lag]])
            owner.append("")
    names = list(scaled)
    pairs = [(a, b) for i, a in enumerate(names) for b in names[:i]][:MOST_PAIRS]
    for a, b in pairs:
        columns += [np.tanh(scaled[a]) * scaled[b], scaled[a] * np.tanh(3.0 * scaled[b])]
        owner += ["", ""]
    return Basis(np.stack(columns, axis=-1) if columns else np.zeros((0, 0)), tuple(owner))


def knots(x: np.ndarray) -> np.ndarray:
    """Return the knots of a state: quantiles, its ends repeated."""
    inner = np.unique(np.quantile(x, np.linspace(0.0, 1.0, KNOTS)))
    return np.r_[[inner[0]] * DEGREE, inner, [inner[-1]] * DEGREE]


def splines(x: np.ndarray, at: np.ndarray) -> np.ndarray:
    """Return the B-splines of a state, its mean left out, (n, k)."""
    inside = np.clip(x, at[0], at[-1])
    full = BSpline.design_matrix(inside, at, DEGREE).toarray()
    return (full - full.mean(axis=0))[:, 1:]
