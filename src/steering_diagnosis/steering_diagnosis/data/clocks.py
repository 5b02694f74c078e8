"""Offset and drift between two clocks, from channels that move together."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from steering_diagnosis.data.record import PERIOD_S
from steering_diagnosis.data.resample import Sampled, on_grid

PARTNERS = (
    ("steering_wheel_angle", "rack_position"),
    ("steering_wheel_angle", "steering_wheel_speed"),
    ("rack_position", "rack_speed"),
    ("torsion_bar_torque", "rack_force"),
    ("steering_wheel_speed", "rack_speed"),
)
"""Channels of which one tells when the other moves; the second may be the first one's rate."""

RATES = {"steering_wheel_speed": "steering_wheel_angle", "rack_speed": "rack_position"}
LONGEST_S = 0.5
WINDOW_S = 4.0
LEAST_CORRELATION, MOST_LEFT = 0.6, 0.5


@dataclass(frozen=True)
class Offset:
    """One clock against another: offset [s] at the beginning, drift, and the scatter [s]."""

    offset: float
    drift: float
    scatter: float
    pair: tuple[str, str]


def estimate(reference: dict[str, Sampled], other: dict[str, Sampled]) -> Offset | None:
    """Return how late the ``other`` clock's channels are; None without a pair of partners."""
    for first, second in PARTNERS:
        for here, there in ((first, second), (second, first)):
            if here in reference and there in other:
                found = _pair(reference[here], other[there])
                if found is not None:
                    return found
    return None


def _pair(here: Sampled, there: Sampled) -> Offset | None:
    start = max(here.time[0], there.time[0])
    count = int((min(here.time[-1], there.time[-1]) - start) / PERIOD_S)
    window = round(WINDOW_S / PERIOD_S)
    if count < 2 * window:
        return None
    a, b = on_grid(here, start, count), on_grid(there, start, count)
    if RATES.get(there.name) == here.name:
        a = np.gradient(a, PERIOD_S)
    elif RATES.get(here.name) == there.name:
        b = np.gradient(b, PERIOD_S)
    coarse = _coarse(a, b)
    if coarse is None:
        return None
    firsts = range(0, count - window + 1, window // 2)
    found = [_fine(a, b, np.arange(first, first + window), coarse) for first in firsts]
    pairs = [
        (start + (first + window / 2) * PERIOD_S, lag)
        for first, lag in zip(firsts, found, strict=True)
        if lag is not None
    ]
    if len(pairs) < 3:
        return None
    middles, lags = np.array(pairs).T
    drift, offset = np.polyfit(middles, lags, 1)
    scatter = float(np.std(lags - np.polyval((drift, offset), middles)))
    return Offset(float(offset), float(drift), scatter, (here.name, there.name))


def _coarse(a: np.ndarray, b: np.ndarray) -> float | None:
    """Return by how many samples ``b`` lags ``a`` over the whole record; None where unlike.

    The highest peak of their cross-correlation within half a second; gaps count as zero.
    """
    a, b = (np.nan_to_num(v - np.nanmean(v)) for v in (a, b))
    power = np.sqrt(np.sum(a * a) * np.sum(b * b))
    size = 1 << (2 * len(a) - 1).bit_length()
    cross = np.fft.irfft(np.conj(np.fft.rfft(a, size)) * np.fft.rfft(b, size), size)
    reach = round(LONGEST_S / PERIOD_S)
    lags = np.arange(-reach, reach + 1)
    values = np.abs(cross[lags])
    best = int(np.argmax(values))
    alike = power > 0.0 and values[best] > LEAST_CORRELATION * power
    return float(lags[best]) if alike else None


def _fine(a: np.ndarray, b: np.ndarray, at: np.ndarray, lag: float) -> float | None:
    """Return the lag [s] in the samples ``at``: a = c b(t + lag) + d by Gauss-Newton.

    None where the channels hardly move, do not match, or have a gap.
    """
    slope, samples, wanted = np.gradient(b), np.arange(len(b)), a[at]
    if not np.all(np.isfinite(wanted)):
        return None
    for _ in range(4):
        moved, moved_slope = (np.interp(at + lag, samples, v) for v in (b, slope))
        columns = np.stack([moved, moved_slope, np.ones(len(at))], axis=1)
        if not np.all(np.isfinite(columns)):
            return None
        (gain, shift, _), *_ = np.linalg.lstsq(columns, wanted, rcond=None)
        if gain == 0.0:
            return None
        lag += float(np.clip(shift / gain, -20.0, 20.0))
    left_over = np.std(wanted - columns @ np.linalg.lstsq(columns, wanted, rcond=None)[0])
    return lag * PERIOD_S if left_over < MOST_LEFT * np.std(wanted) else None
