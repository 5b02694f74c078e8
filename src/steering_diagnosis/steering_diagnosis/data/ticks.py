"""A logger's samples as ticks: what its clock and its stamps do is no motion of the gear.

A logger that samples once a tick has a clock of its own, some ppm off, and stamps that jitter. To
interpolate between its samples would smear commands that jump at ticks, and move samples that were
taken at even intervals.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import replace

import numpy as np

from steering_diagnosis.data.record import PERIOD_S
from steering_diagnosis.data.resample import Sampled

MOST_DRIFT = 2e-4
"""Of a clock, relative: a tenth of the tolerance of a speed's gain, which it looks like. Crystals
are off by 1e-5 to 1e-4."""

MOST_JITTER = 0.2
"""Standard deviation of stamps [periods] up to which it is certain which sample is which."""

SAME_PHASE = 0.02
"""Of two channels, and of one at its end [periods]: what is closer is sampled together."""

REFERENCE = "steering_wheel_angle"
"""The channel whose clock is followed: it drives the replay."""


def in_ticks(channels: dict[str, Sampled], notes: list[str]) -> dict[str, Sampled]:
    """Return channels on the clock of ``REFERENCE``'s samples where these come once a tick.

    All are scaled alike, so that they stay together. Stamps that jitter about even intervals are
    put right, unless the samples themselves tell that they were taken when the stamps say.
    """
    reference = channels.get(REFERENCE) or next(iter(channels.values()))
    period = _period(reference)
    drift = period / PERIOD_S - 1.0
    if abs(drift) > MOST_DRIFT:
        return channels
    start = float(reference.time[0])
    scaled = {
        name: replace(c, time=start + (c.time - start) / (1.0 + drift), period=c.period)
        for name, c in channels.items()
    }
    even = {name: found for name, c in scaled.items() if (found := _even(c, start)) is not None}
    if not even:
        return channels
    if _true_stamps((scaled[name], time) for name, time in even.items()):
        return scaled
    if abs(drift) > 1e-6:
        notes.append(
            f"the file's clock runs {drift * 1e6:+.0f} ppm against one sample a tick: a sample is "
            "taken for a tick"
        )
    return {n: replace(c, time=even.get(n, c.time)) for n, c in scaled.items()}


def _period(channel: Sampled) -> float:
    """Return the interval at which a channel was sampled [s], lost samples counted."""
    ticks = np.concatenate([[0.0], np.cumsum(np.round(np.diff(channel.time) / channel.period))])
    if ticks[-1] == 0.0:
        return channel.period
    return float(np.polyfit(ticks, channel.time - channel.time[0], 1)[0])


def _even(channel: Sampled, start: float) -> np.ndarray | None:
    """Return instants a tick apart for a channel's samples; None where it was sampled otherwise."""
    ticks = np.round((channel.time - channel.time[0]) / PERIOD_S)
    left = channel.time - channel.time[0] - ticks * PERIOD_S
    if np.any(np.diff(ticks) < 1.0) or np.std(left) > MOST_JITTER * PERIOD_S:
        return None
    drifted = np.polyfit(ticks, left, 1)[0] * ticks[-1]
    if abs(drifted) > SAME_PHASE * PERIOD_S:
        return None
    first = channel.time[0] + float(np.mean(left))
    phase = (first - start) / PERIOD_S
    if abs(phase - round(phase)) < SAME_PHASE:
        first = start + round(phase) * PERIOD_S
    return np.asarray(first + ticks * PERIOD_S)


def _true_stamps(channels: Iterable[tuple[Sampled, np.ndarray]]) -> bool:
    """Return whether samples were taken when their stamps say, and not at the even instants.

    What is fast in a channel then follows its rate times the stamps' deviation: with a factor of 1,
    and of 0 where the stamps alone jitter; pooled over the channels, each in its own noise.
    """
    follows = of = 0.0
    for channel, even in channels:
        late = channel.time - even
        # Third differences leave noise of what is smooth.
        fast = np.diff(channel.values, 3)
        moved = np.diff(np.gradient(channel.values, even) * late, 3)
        noise = float(np.mean(fast**2))
        if noise > 0.0:
            follows += float(fast @ moved) / noise
            of += float(moved @ moved) / noise
    return of > 0.0 and follows > 0.5 * of
