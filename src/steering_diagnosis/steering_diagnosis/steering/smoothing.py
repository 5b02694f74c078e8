"""Measured inputs as smooth curves: noise must not enter the replay as acceleration."""

from __future__ import annotations

from copy import copy
from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from scipy import signal
from scipy.interpolate import CubicSpline

from steering_diagnosis.data.record import PERIOD_S, RATE_HZ
from steering_diagnosis.engine.sampling import low_passed

SEGMENT = 2048
NOISE_BAND = 0.7
"""Share of half a channel's rate above which nothing of a steering gear moves: what is there is
noise. Above 350 Hz of a channel on ticks."""

LOWEST_HZ, HIGHEST_HZ = 12.0, 120.0
ABOVE_NOISE = 3.0
"""Spectral density over the noise's from which a frequency belongs to the signal."""

RELATED, HARMLESS = 0.3, 0.1
"""Share of an error that follows the motion from which it is none of noise; and share of a sample's
noise below which it may: a driver who feels the noise moves with it."""

EDGE = 300
ORDER = 3


@dataclass(frozen=True)
class Spectrum:
    """Noise of a channel: standard deviation of a sample, and where the signal sinks into it."""

    noise: float
    cutoff_hz: float


def spectrum(
    values: np.ndarray, lowest_hz: float = LOWEST_HZ, rate_hz: float = RATE_HZ
) -> Spectrum:
    """Return noise and cut-off of ``values``, (n,) without NaN, on the record's grid.

    lowest_hz: least cut-off. rate_hz: at which the channel was sampled before it was interpolated;
    the noise is that of a channel on ticks which has as much of it in the frequencies of motion.
    """
    segment = min(SEGMENT, len(values))
    hz, density = signal.welch(
        values, 1.0 / PERIOD_S, "hann", segment, detrend="linear", average="median"
    )
    top = 0.5 * min(rate_hz, RATE_HZ)
    left = _interpolated(hz, rate_hz)
    band = (hz >= NOISE_BAND * top) & (hz <= top)
    floor = float(np.median(density[band] / left[band]))
    loud = np.flatnonzero((density > ABOVE_NOISE * floor * left) & (hz < NOISE_BAND * top))
    quiet = np.flatnonzero(np.diff(loud) > max(3, len(hz) // 100))
    last = loud[quiet[0]] if len(quiet) else (loud[-1] if len(loud) else 0)
    cutoff = float(np.clip(1.5 * hz[last], lowest_hz, min(HIGHEST_HZ, max(top, lowest_hz))))
    return Spectrum(float(np.sqrt(floor * 0.5 / PERIOD_S)), cutoff)


def _interpolated(hz: np.ndarray, rate_hz: float) -> np.ndarray:
    """Return the share of white noise's power that straight lines between samples leave at ``hz``.

    Samples at ``rate_hz`` with a triangle of that width about each, and what the grid folds back
    (Oppenheim, Schafer: Discrete-Time Signal Processing, 4.6).
    """
    if rate_hz >= RATE_HZ:
        return np.ones_like(hz)
    folded = hz[:, None] + RATE_HZ * np.arange(-2, 3)
    return np.asarray(np.sum(np.sinc(folded / rate_hz) ** 4, axis=1))


def noise_like(
    values: np.ndarray, random: np.random.Generator, rate_hz: float = RATE_HZ
) -> np.ndarray:
    """Return another draw of the noise of a channel (n,) without NaN, coloured as its own is.

    Its density is the channel's own where the signal has sunk into the noise; below, where the
    signal hides it, that of the lowest such octave. A sensor's noise is seldom white, and a rack
    rings on its torsion bar with what it holds there. rate_hz: at which the channel was sampled.
    """
    known = spectrum(values, rate_hz=rate_hz)
    segment = min(SEGMENT, len(values))
    hz, density = signal.welch(
        values, 1.0 / PERIOD_S, "hann", segment, detrend="linear", average="median"
    )
    ends = [max(known.cutoff_hz / 1.5, LOWEST_HZ)]
    while 2.0 * ends[-1] < 0.5 / PERIOD_S:
        ends.append(2.0 * ends[-1])
    bands = list(pairwise([*ends[:-1], 0.5 / PERIOD_S]))
    middles = [np.sqrt(low * high) for low, high in bands]
    levels = [float(np.median(density[(hz > low) & (hz <= high)])) for low, high in bands]
    lines = np.maximum(np.fft.rfftfreq(len(values), PERIOD_S), 1e-9)
    shape = np.interp(np.log(lines), np.log(middles), levels)
    white = np.fft.rfft(random.standard_normal(len(values)))
    return np.asarray(np.fft.irfft(white * np.sqrt(shape * 0.5 / PERIOD_S), len(values)))


def low_pass(values: np.ndarray, cutoff_hz: float) -> np.ndarray:
    """Return ``values`` (n, ...) low-passed with zero phase."""
    return low_passed(values, ORDER, 2.0 * cutoff_hz * PERIOD_S, min(EDGE, len(values) - 1))


def is_noise(error: np.ndarray, motion: np.ndarray, noise: float) -> bool:
    """Return whether an error (n,) is no more than noise, and no gain or delay of a motion (n,).

    The ends, where low-passes miss what comes before and after, do not count.
    """
    inner = slice(EDGE, -EDGE) if len(error) > 4 * EDGE else slice(None)
    columns = np.column_stack([motion, np.gradient(motion)])[inner]
    solved = np.linalg.lstsq(columns, error[inner], rcond=None)[0]
    size, following = np.std(error[inner]), np.std(columns @ solved)
    return bool(size < noise and following < max(RELATED * size, HARMLESS * noise))


def integrated(values: np.ndarray, known: Spectrum) -> np.ndarray:
    """Return the integral over time of a rate (n,), low-passed first where it is noisy."""
    if known.noise > 1e-4 * np.std(values):
        values = low_pass(values, known.cutoff_hz)
    time = np.arange(len(values)) * PERIOD_S
    return np.asarray(CubicSpline(time, values).antiderivative()(time))


def bridged(values: np.ndarray) -> np.ndarray:
    """Return ``values`` (n,) with straight lines over NaN; zeros where there is nothing at all."""
    known = np.isfinite(values)
    if known.all():
        return values
    if not known.any():
        return np.zeros_like(values)
    index = np.arange(len(values))
    return np.interp(index, index[known], values[known])


class Curve:
    """A measured channel as a twice differentiable curve, continued before its beginning.

    values: (n,). negligible: noise below which it is taken as it is. before: ticks of continuation.
    moving: mirror them through the first value, so that motion goes on as it was; else hold it.
    cutoff_hz: of the low-pass; None: where the signal sinks into its noise. rate_hz: at which the
    channel was sampled.
    """

    def __init__(
        self,
        values: np.ndarray,
        negligible: float,
        before: int,
        moving: bool = False,
        cutoff_hz: float | None = None,
        rate_hz: float = RATE_HZ,
    ) -> None:
        values = bridged(np.asarray(values, dtype=np.float64))
        self._before, self._moving = before, moving
        self.spectrum = spectrum(values, rate_hz=rate_hz)
        self.cutoff_hz = self.spectrum.cutoff_hz if cutoff_hz is None else cutoff_hz
        self.smoothed = cutoff_hz is not None or self.spectrum.noise > negligible
        self.low_passed = self.smoothed
        if self.smoothed:
            values = low_pass(values, self.cutoff_hz)
        self._set(values)

    def _set(self, values: np.ndarray) -> None:
        before = self._before
        mirrored = 2.0 * values[0] - values[before:0:-1]
        led_in = mirrored if self._moving else np.full(before, values[0])
        self.values = np.concatenate([led_in, values])
        self._time = np.arange(len(self.values)) * PERIOD_S
        self._spline = CubicSpline(self._time, self.values)
        self._plain: dict[int, np.ndarray] = {}

    def replaced(self, values: np.ndarray, low_passed: bool = False) -> Curve:
        """Return a curve with other ``values`` (n,), smooth already, for the same sensor.

        low_passed: whether they are still what the low-pass leaves of the channel, with less noise.
        """
        other = copy(self)
        other.low_passed = low_passed
        other._set(values)
        return other

    def taken(self, delay: float = 0.0, lag: float = 0.0, order: int = 0) -> np.ndarray:
        """Return the ``order``-th derivative of what a sensor with ``delay`` and ``lag`` felt."""
        if delay == 0.0 and lag == 0.0:
            if order not in self._plain:
                self._plain[order] = self._spline(self._time, order)
            return self._plain[order]
        time = self._time if delay == 0.0 else np.minimum(self._time + delay, self._time[-1])
        felt = self._spline(time, order)
        return felt if lag == 0.0 else felt + lag * self._spline(time, order + 1)


def begins_moving(values: np.ndarray) -> bool:
    """Return whether a position (n,) moves at its beginning as it does in the record."""
    smooth = low_pass(bridged(values), LOWEST_HZ)
    speed = np.gradient(smooth)
    return bool(np.abs(speed[:20]).mean() > 0.1 * np.sqrt(np.mean(speed**2)))
