"""Does a difference grow with the frequency of steering?

The steering wheel angle is cut into half-cycles at its zero crossings. A half-cycle of duration d
has the frequency 1/(2 d); the difference within it has a peak. A difference that comes from the
valves' dynamics is next to nothing in slow half-cycles and rises with frequency; a static one
(another boost curve, another friction) is there from the slowest on.
"""

from __future__ import annotations

from dataclasses import dataclass
from itertools import pairwise

import numpy as np

MINIMUM_HALF_CYCLES = 5
MINIMUM_FREQUENCY_RATIO = 1.5
GROWING_RANK = 0.8
STATIC_SHARE = 0.15
BAND_EDGES_HZ = (0.0, 0.5, 1.0, 2.0, 5.0, 10.0, 20.0, 50.0, 500.0)


@dataclass(frozen=True)
class Growth:
    """Peaks of a difference by half-cycle.

    time [s], frequency [Hz], peak: (m,), a half-cycle each. rank: Spearman's rank correlation of
    peak with frequency. static_share: what a straight line through the peaks leaves at zero
    frequency, over the largest peak (negative if the peaks rise faster than the frequency).
    """

    time: np.ndarray
    frequency: np.ndarray
    peak: np.ndarray
    rank: float
    static_share: float

    @property
    def with_frequency_only(self) -> bool:
        """Whether the difference rises with frequency and nothing of it is left at standstill."""
        return self.rank >= GROWING_RANK and self.static_share <= STATIC_SHARE


def half_cycles(time: np.ndarray, angle: np.ndarray) -> np.ndarray:
    """Times (m + 1,) [s] that bound the half-cycles of a steering wheel angle (n,).

    Zero crossings count once the angle has passed a tenth of its largest value on either side, so
    that noise around zero does not make any. The start counts if the angle starts near zero.
    """
    level = 0.1 * float(np.max(np.abs(angle), initial=0.0))
    side = np.where(angle > level, 1, np.where(angle < -level, -1, 0))
    outside = np.flatnonzero(side)
    if level == 0.0 or not len(outside):
        return np.empty(0)
    flips = np.flatnonzero(np.diff(side[outside]))
    bounds = [float(time[0])] if side[0] == 0 else []
    for k in flips:
        a, b = outside[k], outside[k + 1]
        crossing = a + int(np.argmax(np.sign(angle[a : b + 1]) != np.sign(angle[a])))
        before, after = angle[crossing - 1], angle[crossing]
        share = before / (before - after)
        bounds.append(float(time[crossing - 1] + share * (time[crossing] - time[crossing - 1])))
    return np.array(bounds)


def growth(time: np.ndarray, angle: np.ndarray, error: np.ndarray) -> Growth | None:
    """Growth of a difference `error` (n,) with the frequency of `angle` (n,).

    None where it cannot be judged: too few half-cycles, or all of one frequency.
    """
    bounds = half_cycles(time, angle)
    if len(bounds) < MINIMUM_HALF_CYCLES + 1:
        return None
    frequency = 0.5 / np.diff(bounds)
    if frequency.max() < MINIMUM_FREQUENCY_RATIO * frequency.min():
        return None
    edges = np.searchsorted(time, bounds)
    peak = np.array([np.max(np.abs(error[a:b])) for a, b in pairwise(edges)])
    _, rest = np.polyfit(frequency, peak, 1)
    static = float(rest / peak.max()) if peak.max() > 0.0 else 0.0
    return Growth(0.5 * (bounds[1:] + bounds[:-1]), frequency, peak, _rank(frequency, peak), static)


def _rank(x: np.ndarray, y: np.ndarray) -> float:
    """Spearman's rank correlation; 0 if one of them is constant. Equal values keep their order."""
    if np.ptp(x) == 0.0 or np.ptp(y) == 0.0:
        return 0.0
    ranks = [np.argsort(np.argsort(v, kind="stable"), kind="stable") for v in (x, y)]
    return float(np.corrcoef(ranks[0], ranks[1])[0, 1])


def bands(error: np.ndarray, step: float) -> list[tuple[float, float, float]]:
    """Rms of a difference (n,) in frequency bands: (from Hz, to Hz, rms); step [s].

    The squares of the bands sum up to the square of the whole difference's rms (Parseval).
    """
    count = len(error)
    spectrum = np.abs(np.fft.rfft(error)) ** 2 / count**2
    double = np.full(len(spectrum), 2.0)
    double[0] = 1.0
    if count % 2 == 0:
        double[-1] = 1.0
    frequency = np.fft.rfftfreq(count, step)
    power = spectrum * double
    edges = [*BAND_EDGES_HZ[:-1], np.inf]
    result = []
    for k, (low, high) in enumerate(pairwise(edges)):
        inside = (frequency >= low) & (frequency < high)
        result.append((low, BAND_EDGES_HZ[k + 1], float(np.sqrt(np.sum(power[inside])))))
    return result
