"""Smooth functions of the states: what structure without a name may depend on."""

from __future__ import annotations

import numpy as np
from scipy.interpolate import BSpline

KNOTS = 40
COARSE, FINE = 5, 72
LAGS = (1, 2, 4, 8)
ORDERS = 40
"""Harmonics of an angle, in periods a turn: gear teeth, magnets."""
DEGREE = 2
DIRECTED = 0.1
"""Share of a state's usual speed at which its direction is certain."""


def usable_state(x: np.ndarray) -> np.ndarray | None:
    """Return a state without gaps, None where it does not move."""
    x = np.nan_to_num(x)
    return x if np.ptp(x) > 1e-12 * (np.abs(x).max() + 1e-300) else None


def single(x: np.ndarray) -> np.ndarray:
    """Return splines in a state and its lagged differences, (n, k)."""
    scaled = (x - x.mean()) / x.std()
    lagged = [np.r_[np.zeros(k), scaled[k:] - scaled[:-k]] for k in LAGS]
    return np.c_[splines(x, knots(x, KNOTS)), np.stack(lagged, axis=-1)]


def repeated(x: np.ndarray) -> np.ndarray:
    """Return fine, evenly spaced splines in a state, (n, k): for what repeats along it."""
    even = np.linspace(x.min(), x.max(), FINE + 1)
    return splines(x, np.r_[[even[0]] * DEGREE, even, [even[-1]] * DEGREE])


def orders(angle: np.ndarray) -> np.ndarray:
    """Return the harmonics of an angle [rad], (n, k): what comes again with every turn."""
    phase = angle[:, None] * np.arange(1, ORDERS + 1)
    both = np.c_[np.cos(phase), np.sin(phase)]
    return both - both.mean(axis=0)


def by_direction(x: np.ndarray) -> np.ndarray:
    """Return splines in a state whose sign is that of its motion, (n, k): friction, hysteresis."""
    rate = np.gradient(x)
    way = np.tanh(rate / (DIRECTED * np.sqrt(np.mean(rate**2))))
    turned = splines(x, knots(x)) * way[:, None]
    return np.c_[way, turned] - np.r_[way.mean(), turned.mean(axis=0)]


def product(x: np.ndarray, y: np.ndarray) -> np.ndarray:
    """Return products of coarse splines in two states, (n, k)."""
    a, b = splines(x, knots(x, COARSE)), splines(y, knots(y, COARSE))
    both = (a[:, :, None] * b[:, None, :]).reshape(len(x), -1)
    return both - both.mean(axis=0)


def knots(x: np.ndarray, count: int = KNOTS) -> np.ndarray:
    """Return the knots of a state: half by quantiles, half evenly, its ends repeated."""
    even = np.linspace(x.min(), x.max(), count // 2 + 1)
    inner = np.unique(np.r_[np.quantile(x, np.linspace(0.0, 1.0, count // 2 + 1)), even])
    kept = inner[np.r_[True, np.diff(inner) > 1e-3 * np.ptp(x)]]
    kept[-1] = inner[-1]
    return np.r_[[kept[0]] * DEGREE, kept, [kept[-1]] * DEGREE]


def splines(x: np.ndarray, at: np.ndarray) -> np.ndarray:
    """Return the B-splines of a state, its mean left out, (n, k)."""
    inside = np.clip(x, at[0], at[-1])
    full = BSpline.design_matrix(inside, at, DEGREE).toarray()
    return (full - full.mean(axis=0))[:, 1:]
