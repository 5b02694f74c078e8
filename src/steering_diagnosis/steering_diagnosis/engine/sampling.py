"""One zero-phase low-pass and one grid for everything, and the blocks that are held out."""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache

import numpy as np
from scipy import signal

from steering_core.errors import BenchError
from steering_diagnosis.engine.settings import Settings

LEAST_SAMPLES = 200
ORDER = 6
ROLL_OFF = 0.8
"""Bandwidth over the decimated grid's Nyquist frequency."""


@lru_cache(maxsize=256)
def _low_pass(order: int, frequency: float) -> tuple[np.ndarray, np.ndarray]:
    """Return the sections of a Butterworth low-pass, and their states at rest under 1.

    A diagnosis asks for the same few some thousand times; the design takes longer than the filter.
    """
    sections = np.asarray(signal.butter(order, frequency, output="sos"))
    return sections, np.asarray(signal.sosfilt_zi(sections))


def low_passed(
    values: np.ndarray, order: int, frequency: float, edge: int | None = None
) -> np.ndarray:
    """Return ``values`` (n, ...) through a Butterworth low-pass forwards and backwards.

    As ``scipy.signal.sosfiltfilt``, digit for digit, in half its time. frequency: over Nyquist's, 0
    to 1. edge: samples by which the ends are continued; None: scipy's own choice.
    """
    sections, at_rest = _low_pass(order, frequency)
    if edge is None:
        edge = 3 * (order + 1)
    rows = np.ascontiguousarray(values.reshape(len(values), -1).T)
    before = 2.0 * rows[:, :1] - rows[:, edge:0:-1]
    behind = 2.0 * rows[:, -1:] - rows[:, -2 : -(edge + 2) : -1]
    rows = np.concatenate([before, rows, behind], axis=1)
    for _ in range(2):
        begin = at_rest[:, None, :] * rows[:, :1]
        rows = signal.sosfilt(sections, rows, zi=begin)[0][:, ::-1]
    return np.asarray(rows[:, edge : rows.shape[1] - edge].T.reshape(values.shape))


@dataclass(frozen=True)
class Sampling:
    """From the record's grid to the decimated one. bandwidth_hz: of the low-pass."""

    period_s: float
    factor: int
    bandwidth_hz: float

    @property
    def step_s(self) -> float:
        """Period of the decimated grid [s]."""
        return self.period_s * self.factor

    @property
    def density(self) -> float:
        """Independent samples per decimated sample: the pass band's share."""
        return min(1.0, 2.0 * self.bandwidth_hz * self.step_s)

    def reduce(self, raw: np.ndarray) -> np.ndarray:
        """Filter and decimate (n,) or (n, m); gaps stay NaN, one filter length wider."""
        columns = raw.reshape(len(raw), -1)
        finite = np.isfinite(columns)
        filled = columns if finite.all() else _bridged(columns, finite)
        if 2.0 * self.bandwidth_hz * self.period_s < 1.0:
            filled = low_passed(filled, ORDER, 2.0 * self.bandwidth_hz * self.period_s)
        kept = filled[:: self.factor].copy()
        kept[~_clear(finite, 2 * self.factor)[:: self.factor]] = np.nan
        return kept.reshape(-1, *raw.shape[1:])


def sampling(samples: int, period_s: float, settings: Settings) -> Sampling:
    """Return the grid for a record of ``samples``. BenchError: fewer than 200."""
    if samples < LEAST_SAMPLES:
        raise BenchError(
            f"the record has {samples} samples, too few to judge: record at least "
            f"{LEAST_SAMPLES} ({LEAST_SAMPLES * period_s:.3g} s), better 10 s or more"
        )
    by_band = int(ROLL_OFF / (2.0 * settings.bandwidth_hz * period_s))
    by_length = -(-samples // settings.most_samples)
    most = max(1, samples // LEAST_SAMPLES)
    factor = min(max(1, by_band, by_length), most)
    nyquist = 0.5 / (period_s * factor)
    return Sampling(period_s, factor, min(settings.bandwidth_hz, ROLL_OFF * nyquist))


def blocks(samples: int, step_s: float, settings: Settings) -> np.ndarray:
    """Return the block number of every decimated sample, (n,)."""
    count = int(np.clip(samples * step_s / settings.block_s, 8, settings.blocks))
    return np.arange(samples) * count // samples


def moments(samples: int, step_s: float, settings: Settings) -> np.ndarray:
    """Return the number of the short time that each decimated sample belongs to, (n,)."""
    return (np.arange(samples) * step_s / settings.moment_s).astype(int)


def held_out(block: np.ndarray, every: int) -> np.ndarray:
    """Return which samples are held out: every such block, spread over the record."""
    return block % every == every // 2


def _bridged(columns: np.ndarray, finite: np.ndarray) -> np.ndarray:
    """Bridge gaps by straight lines, so that the filter has something to work on."""
    filled = columns.copy()
    for j in np.flatnonzero(~finite.all(axis=0)):
        missing, known = np.flatnonzero(~finite[:, j]), np.flatnonzero(finite[:, j])
        if not len(known):
            filled[:, j] = 0.0
            continue
        after = np.searchsorted(known, missing)
        ends = known[np.maximum(after - 1, 0)], known[np.minimum(after, len(known) - 1)]
        first, last = columns[ends[0], j], columns[ends[1], j]
        span = np.maximum(ends[1] - ends[0], 1)
        within = np.clip(missing - ends[0], 0, span)
        filled[missing, j] = first + (last - first) / span * within
    return filled


def _clear(finite: np.ndarray, width: int) -> np.ndarray:
    """Return where nothing within ``width`` samples is missing."""
    if finite.all():
        return finite
    missing = np.cumsum(np.pad(~finite, ((width + 1, width), (0, 0))), axis=0)
    return missing[2 * width + 1 :] == missing[: -2 * width - 1]
