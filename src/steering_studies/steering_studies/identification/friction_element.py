"""The friction element of a measured motion, at limit one (Pfeffer's exponential spring)."""

from __future__ import annotations

import numpy as np

from steering_core.compiled import kernel


@kernel
def _follow(position: np.ndarray, displacement: float, out: np.ndarray) -> None:
    share = 0.0
    for i in range(1, position.shape[0]):
        step = position[i] - position[i - 1]
        if step > 0.0:
            share = 1.0 - (1.0 - share) * np.exp(-step / displacement)
        elif step < 0.0:
            share = -1.0 + (1.0 + share) * np.exp(step / displacement)
        out[i] = share


def friction_share(position: np.ndarray, displacement: float) -> np.ndarray:
    """Return force over limit, (n,), of a motion (n,): exact for motion in straight pieces.

    dF/dx = (1 - F sign(v))/x_0, so that F tends to +-1 exponentially in displacement.
    """
    out = np.zeros(len(position))
    _follow(np.ascontiguousarray(position), float(displacement), out)
    return out
