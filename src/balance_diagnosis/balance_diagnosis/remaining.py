"""What is left beside the causes, and where: in which frequencies, and when."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from scipy.signal import welch

from balance_diagnosis.held_out import Curve

PIECES = 8
"""Of a record, for its spectrum: enough to average noise away, long enough for slow errors."""

PARTS = 10
"""Of a record, of which the one with the largest error is told."""


@dataclass(frozen=True)
class Band:
    """What the extended model leaves of an output of a record.

    rms: in the output's unit. share: of the nominal model's error energy; above one where the
    extended model is worse. low, high: frequencies [Hz] between which the middle half of its energy
    lies. start, stop: the tenth of the record [s] with the most of it, and its part of the energy.
    """

    record: str
    output: str
    held_out: bool
    rms: float
    share: float
    low: float
    high: float
    start: float
    stop: float
    part: float


def bands(told: Sequence[Curve]) -> list[Band]:
    """Return what is left of each output of each record."""
    return [_band(curve) for curve in told if np.isfinite(curve.measured).any()]


def _band(curve: Curve) -> Band:
    error = curve.measured - curve.extended
    judged = np.isfinite(error)
    left = np.where(judged, error, 0.0)
    before = np.where(judged, curve.measured - curve.nominal, 0.0)
    energy = float(left @ left)
    low, high = _middle_half(left, judged, curve.times)
    parts = np.array_split(np.arange(len(left)), PARTS)
    sizes = [float(left[part] @ left[part]) for part in parts]
    worst = parts[int(np.argmax(sizes))]
    return Band(
        curve.record,
        curve.output,
        curve.held_out,
        float(np.sqrt(energy / judged.sum())),
        energy / max(float(before @ before), 1e-300),
        low,
        high,
        float(curve.times[worst[0]]),
        float(curve.times[worst[-1]]),
        max(sizes) / max(energy, 1e-300),
    )


def _middle_half(left: np.ndarray, judged: np.ndarray, times: np.ndarray) -> tuple[float, float]:
    """Return the frequencies [Hz] below which a quarter and three quarters of the energy lie.

    What is not judged counts as no error: gaps blur a spectrum, and hide nothing.
    """
    centred = np.where(judged, left - left[judged].mean(), 0.0)
    rate = 1.0 / float(np.median(np.diff(times)))
    frequencies, power = welch(
        centred, rate, nperseg=max(len(left) // PIECES, min(len(left), 32)), detrend=False
    )
    total = np.cumsum(power)
    if not total[-1] > 0.0:
        return 0.0, 0.0
    quarter, three = np.searchsorted(total, (0.25 * total[-1], 0.75 * total[-1]))
    return float(frequencies[quarter]), float(frequencies[three])
