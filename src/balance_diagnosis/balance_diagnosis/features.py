"""Smooth functions of states, of their recent past and of directions, for noise and check.

Random Fourier features (Rahimi, Recht 2007) of the normalised states; each group has a total
variance of one. They span what a wrong formula leaves, which slow noise does not follow.
"""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
from scipy.signal import lfilter

PASTS = (1.0 / 200.0, 1.0 / 40.0)
"""Lengths of the recent past, as shares of the record."""

FARTHEST = 4.0
"""Deviations beyond which a state counts no further."""

TURN = 0.1
"""Deviations within which a direction turns round."""


def smooth_functions(states: Mapping[str, np.ndarray], count: int, seed: int = 0) -> np.ndarray:
    """Return the functions, (n, k), of states (n,) each. The same for the same seed."""
    draw = np.random.default_rng(seed)
    moving = [x for x in (np.nan_to_num(v) for v in states.values()) if _moves(x)]
    if not moving:
        return np.zeros((len(next(iter(states.values()))), 0))
    now = np.stack([np.clip((x - x.mean()) / x.std(), -FARTHEST, FARTHEST) for x in moving], axis=1)
    n = len(now)
    past = [now] + [_slow(now, share * n) for share in PASTS]
    signs = np.stack([sign for x in moving for sign in _directions(x)], axis=1)
    small = np.concatenate([np.ones((n, 1)), _waves(now, max(count // 8, 2), draw)], axis=1)
    directed = (signs[:, :, None] * small[:, None, :]).reshape(n, -1) / np.sqrt(2 * signs.shape[1])
    groups = [_waves(now, count, draw), _waves(np.concatenate(past, axis=1), count, draw), directed]
    return np.concatenate(groups, axis=1) / np.sqrt(len(groups))


def slow_functions(n: int, count: int = 12) -> np.ndarray:
    """Return cosines of time of falling amplitude, (n, count): drift, which is noise."""
    k = np.arange(1, count + 1)
    time = (np.arange(n) + 0.5) / n
    return np.cos(np.pi * np.outer(time, k)) / k


def _moves(x: np.ndarray) -> bool:
    return bool(np.ptp(x) > 1e-12 * (np.abs(x).max() + 1e-300))


def _slow(values: np.ndarray, samples: float) -> np.ndarray:
    keep = float(np.exp(-1.0 / max(samples, 1e-3)))
    return lfilter([1.0 - keep], [1.0, -keep], values, axis=0, zi=values[:1] * keep)[0]


def _directions(x: np.ndarray) -> list[np.ndarray]:
    """Return which way a state moves, and on which side of zero it is where it has both."""
    slope = np.gradient(x)
    made = [np.tanh(slope / (TURN * slope.std() + 1e-300))]
    if min(x.max(), -x.min()) > TURN * np.abs(x).max():
        made.append(np.tanh(x / (TURN * x.std())))
    return made


def _waves(values: np.ndarray, count: int, draw: np.random.Generator) -> np.ndarray:
    directions = draw.standard_normal((values.shape[1], count))
    directions /= np.sqrt(max(0.5 * values.shape[1], 1.0))
    return np.sqrt(2.0 / count) * np.cos(values @ directions + draw.uniform(0.0, 2 * np.pi, count))
