"""How far two signals are apart."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np


@dataclass(frozen=True)
class Difference:
    """Second minus first run, in the signal's SI unit.

    largest: max |difference|, at time `at` [s]; rms; mean; peaks: largest absolute value of the
    signal in each run.
    """

    unit: str
    largest: float
    at: float
    rms: float
    mean: float
    peaks: tuple[float, float]


def difference(time: np.ndarray, first: np.ndarray, second: np.ndarray, unit: str) -> Difference:
    """Difference of two signals (n,) over the time (n,) [s]."""
    error = second - first
    k = int(np.argmax(np.abs(error)))
    return Difference(
        unit=unit,
        largest=float(abs(error[k])),
        at=float(time[k]),
        rms=float(np.sqrt(np.mean(error**2))),
        mean=float(np.mean(error)),
        peaks=(float(np.max(np.abs(first))), float(np.max(np.abs(second)))),
    )
