"""From a channel on its own clock to the record's grid of 1 ms, and what was found on the way."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np
from scipy.signal import firwin, oaconvolve

from steering_core.errors import BenchError
from steering_diagnosis.data.record import PERIOD_S

GAP_PERIODS = 4.0
"""A pause longer than so many of a channel's own periods is a gap and is not bridged."""

ROUNDING_S = 1e-6
"""Within it an instant is a sample's own, on a clock that counts the seconds since 1970 as well."""

JITTER_SHARE = 0.05

SAME_RATE = 1.02
"""Of two periods, within which a channel has a sample for every instant of the grid."""

FEWEST_SAMPLES = 200

MOST_REPEATED = 0.5
"""Share of repeated instants beyond which a time has lost its last digits."""

COVERED_TWICE = 20
"""So many samples in one stretch of time, before and after it went back, are two measurements."""


@dataclass(frozen=True, repr=False)
class Sampled:
    """A channel with its own instants [s], rising, all finite; findings, a sentence each."""

    name: str
    time: np.ndarray
    values: np.ndarray
    findings: tuple[str, ...] = ()
    period: float = field(default=PERIOD_S)

    @property
    def slow(self) -> bool:
        """Whether it was sampled more seldom than the record's grid has instants."""
        return self.period > SAME_RATE * PERIOD_S


def sampled(
    name: str,
    time: np.ndarray,
    values: np.ndarray,
    lost: str = "",
    lines: np.ndarray | None = None,
) -> Sampled:
    """Return a channel in the order of its time, without repeated instants and non-numbers.

    lost: why there are non-numbers, a few words; lines: (n,) each sample's line in a text file.
    Raises BenchError where fewer than 200 samples are left, where most instants are repeated, or
    where time starts again over a stretch that it has covered.
    """
    findings = []
    finite = np.isfinite(time) & np.isfinite(values)
    gone = int(np.count_nonzero(~finite))
    if gone:
        why = f" ({lost})" if lost else ""
        findings.append(f"{name}: {gone} of {len(values)} samples are no numbers{why}: left out")
    place = np.arange(1, len(time) + 1) if lines is None else lines
    time, values, place = time[finite], values[finite], place[finite]
    stray = _stray(time)
    if stray.any():
        far = int(np.flatnonzero(stray)[0])
        findings.append(
            f"{name}: {np.count_nonzero(stray)} instants lie far from all others (first: "
            f"{time[far]:.6g} s in {'sample' if lines is None else 'line'} {place[far]}): left "
            "out"
        )
        time, values, place = time[~stray], values[~stray], place[~stray]
    still = np.flatnonzero(np.diff(time) <= 0.0)
    if len(still):
        at = f"{'sample' if lines is None else 'line'} {place[still[0] + 1]}"
        if (again := _covered_twice(time)) is not None:
            at = f"{'sample' if lines is None else 'line'} {place[again]}"
            raise BenchError(
                f"{name}: time starts again at {at} ({time[again]:.6g} s after "
                f"{time[again - 1]:.6g} s): these are two measurements, give one"
            )
        order = np.argsort(time, kind="stable")
        backwards = int(np.count_nonzero(np.diff(time) < 0.0))
        time, first = np.unique(time[order], return_index=True)
        dropped = len(values) - len(time)
        if dropped > MOST_REPEATED * len(values):
            raise BenchError(
                f"{name}: {dropped} of {len(values)} instants repeat the one before them (first: "
                f"{at}): the time has lost its last digits, or has the wrong unit"
            )
        values = values[order][first]
        findings.append(
            f"{name}: time went back {backwards} times, {dropped} repeated instants left out "
            f"(first: {at})"
        )
    if len(values) < FEWEST_SAMPLES:
        raise BenchError(
            f"{name}: {len(values)} samples are too few to judge anything; at least "
            f"{FEWEST_SAMPLES} are needed"
        )
    period = float(np.median(np.diff(time)))
    findings += _timing(name, time, period)
    findings += _values(name, values)
    return Sampled(name, time, values, tuple(findings), period)


def _stray(time: np.ndarray) -> np.ndarray:
    """Return which instants are none of the record's, (n,) bool.

    Fewer than 20 at either end, further from all others than these span.
    """
    stray = np.zeros(len(time), dtype=bool)
    if len(time) < FEWEST_SAMPLES:
        return stray
    ordered = np.sort(time)
    few = COVERED_TWICE
    span = ordered[-few] - ordered[few - 1]
    if span <= 0.0:
        return stray
    before = np.flatnonzero(np.diff(ordered[:few]) > span)
    behind = np.flatnonzero(np.diff(ordered[-few:]) > span)
    if len(before):
        stray |= time <= ordered[before[-1]]
    if len(behind):
        stray |= time >= ordered[len(ordered) - few + behind[0] + 1]
    return stray


def _covered_twice(time: np.ndarray) -> int | None:
    """Return the index at which time goes back and runs through the same again; None if nowhere.

    Samples that come a little late, and parts in the wrong order, only need to be sorted.
    """
    starts = np.concatenate([[0], np.flatnonzero(np.diff(time) < 0.0) + 1])
    ends = np.concatenate([starts[1:], [len(time)]])
    for start, end in zip(starts[1:], ends[1:], strict=True):
        if end - start < COVERED_TWICE:
            continue
        before, run = time[:start], time[start:end]
        low, high = max(before.min(), run[0]), min(before.max(), run[-1])
        both = (np.count_nonzero((part >= low) & (part <= high)) for part in (before, run))
        if min(both) >= COVERED_TWICE:
            return int(start)
    return None


def _timing(name: str, time: np.ndarray, period: float) -> list[str]:
    """Return what is to be said of rate, jitter and gaps."""
    steps = np.diff(time)
    gaps = steps[steps > GAP_PERIODS * period]
    found = []
    if not 1.0 / SAME_RATE < period / PERIOD_S < SAME_RATE:
        rate = 1.0 / period
        nyquist = f"; nothing above {0.5 * rate:.0f} Hz can be judged" if period > PERIOD_S else ""
        found.append(f"{name}: sampled at {rate:.4g} Hz{nyquist}")
    inner = steps[steps <= GAP_PERIODS * period]
    jitter = float(np.std(inner)) if len(inner) else 0.0
    if jitter > JITTER_SHARE * period:
        found.append(f"{name}: time stamps jitter by {jitter * 1e3:.2g} ms (standard deviation)")
    if len(gaps):
        found.append(
            f"{name}: {len(gaps)} gaps, the longest {gaps.max():.3g} s: not bridged, not judged"
        )
    return found


def _values(name: str, values: np.ndarray) -> list[str]:
    """Return what is to be said of a constant channel or a coarse resolution."""
    span = float(np.ptp(values))
    if span == 0.0:
        return [f"{name}: constant at {values[0]:.6g} over the whole record"]
    step = resolution(values)
    if step > span / 2000.0:
        return [f"{name}: quantised in steps of {step:.3g}, {span / step:.0f} over its range"]
    return []


def resolution(values: np.ndarray) -> float:
    """Return the step of a quantised channel; 0 where none is seen."""
    steps = np.diff(np.unique(values))
    if not len(steps):
        return 0.0
    step = float(np.min(steps))
    multiples = steps / step
    return step if np.median(np.abs(multiples - np.round(multiples))) < 0.02 else 0.0


def on_grid(channel: Sampled, start: float, count: int) -> np.ndarray:
    """Return a channel at ``start`` + k x 1 ms, (count,); NaN outside of it and in its gaps.

    A faster channel is first low-passed without phase below 450 Hz; a slower one is interpolated
    linearly, which adds nothing that was not measured.
    """
    time, values = channel.time, channel.values
    if channel.period < 0.7 * PERIOD_S:
        time, values = _slowed(channel)
    grid = start + np.arange(count) * PERIOD_S
    within = np.clip(grid, time[0], time[-1])
    result = np.where(np.abs(grid - within) < ROUNDING_S, np.interp(within, time, values), np.nan)
    reach = GAP_PERIODS * max(channel.period, PERIOD_S if channel.period < PERIOD_S else 0.0)
    after = np.clip(np.searchsorted(time, grid, side="left"), 1, len(time) - 1)
    inside = time[after] - time[after - 1] > reach
    nearest = np.minimum(np.abs(grid - time[after]), np.abs(grid - time[after - 1]))
    exact = nearest < ROUNDING_S
    result[inside & ~exact] = np.nan
    return result


def _slowed(channel: Sampled) -> tuple[np.ndarray, np.ndarray]:
    """Return a fast channel low-passed on its own regular grid, gaps kept as they are."""
    period = channel.period
    count = round((channel.time[-1] - channel.time[0]) / period) + 1
    regular = channel.time[0] + np.arange(count) * period
    values = np.interp(regular, channel.time, channel.values)
    taps = firwin(2 * round(2.0 * PERIOD_S / period) + 1, 450.0, fs=1.0 / period)
    half = len(taps) // 2
    padded = np.concatenate([np.full(half, values[0]), values, np.full(half, values[-1])])
    smooth = oaconvolve(padded, taps, mode="valid")
    nearest = np.clip(np.searchsorted(channel.time, regular), 1, len(channel.time) - 1)
    in_gap = channel.time[nearest] - channel.time[nearest - 1] > GAP_PERIODS * period
    return regular[~in_gap], smooth[~in_gap]
