"""The tick: the one time base of the bench."""

from __future__ import annotations

import numpy as np

TICKS_PER_SECOND = 1000
TICK_PERIOD = 1.0 / TICKS_PER_SECOND


def tick_times(ticks: int) -> np.ndarray:
    """Return the times [s] of ticks 0 to ``ticks`` - 1, shape (ticks,).

    Divided, not multiplied by the period: tick 3 is the double nearest to 0.003 s, so that a time
    written in a file or a scenario meets its tick exactly.
    """
    return np.arange(ticks, dtype=np.float64) / TICKS_PER_SECOND
