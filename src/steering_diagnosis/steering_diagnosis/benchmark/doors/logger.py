"""How a logger records: on a clock of its own, with stamps that jitter, losses and few digits."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from steering_diagnosis.data.record import PERIOD_S

DRIFT = 5e-5
"""Standard deviation of a crystal's drift."""

JITTER_S = (2e-5, 6e-5)
"""Of time stamps, standard deviation: a hardware stamp's, and that of a quick operating system."""

LONGEST_GAP_S = 0.15
FEW_DIGITS = 4
OTHERS_OFFSET_S = 0.2
"""Largest offset between the clocks of two devices in one file."""


@dataclass(frozen=True)
class Logger:
    """A logger's ways.

    start: its first stamp [s]. drift: relative. jitter: standard deviation [s]. gaps: (beginning
    over the record's length, length [s]) each. lost: share of single samples. digits: significant
    ones, 0: all. other: offset [s] and drift of a second device's clock, which the mapping states;
    only MDF4 files have one.
    """

    start: float = 0.0
    drift: float = 0.0
    jitter: float = 0.0
    gaps: tuple[tuple[float, float], ...] = ()
    lost: float = 0.0
    digits: int = 0
    other: tuple[float, float] = (0.0, 0.0)

    @property
    def ways(self) -> tuple[str, ...]:
        """Return what is not plain about it."""
        has = {
            "clock": self.start != 0.0 or self.drift != 0.0,
            "jitter": self.jitter > 0.0,
            "gaps": bool(self.gaps),
            "digits": self.digits > 0,
        }
        return tuple(name for name, is_so in has.items() if is_so)


def draw_logger(random: np.random.Generator) -> Logger:
    """Return a logger; each of its ways in some cases."""
    clock, jitter, gaps, digits = random.uniform(size=4) < (0.5, 0.5, 0.35, 0.25)
    count = int(random.integers(1, 4))
    places = np.sort(random.uniform(0.1, 0.9, count))
    lengths = random.uniform(0.006, LONGEST_GAP_S, count)
    start = float(random.uniform(0.5, 3600.0))
    drift = float(DRIFT * random.standard_normal())
    stamps = float(random.choice(JITTER_S))
    other = (float(random.uniform(-OTHERS_OFFSET_S, OTHERS_OFFSET_S)), drift * -0.7)
    lost = float(random.choice([0.0, 1e-3]))
    return Logger(
        start=round(start, 6) if clock else 0.0,
        drift=drift if clock else 0.0,
        jitter=stamps if jitter else 0.0,
        gaps=tuple(zip(places.tolist(), lengths.tolist(), strict=True)) if gaps else (),
        lost=lost if gaps else 0.0,
        digits=FEW_DIGITS if digits else 0,
        other=other if clock else (0.0, 0.0),
    )


def stamps(logger: Logger, count: int, random: np.random.Generator) -> np.ndarray:
    """Return the logger's time stamps [s] of ``count`` ticks, rising."""
    ticks = np.arange(count) + logger.jitter / PERIOD_S * np.clip(
        random.standard_normal(count), -4.0, 4.0
    )
    return logger.start + (1.0 + logger.drift) * PERIOD_S * ticks


def kept(logger: Logger, count: int, random: np.random.Generator) -> np.ndarray:
    """Return which ticks the logger did not lose, (n,) bool."""
    there = random.uniform(size=count) >= logger.lost
    for place, length in logger.gaps:
        first = round(place * count)
        there[first : first + round(length / PERIOD_S)] = False
    return there


def rounded(values: np.ndarray, digits: int) -> np.ndarray:
    """Return values (n,) with so many significant digits; 0: as they are."""
    if digits <= 0:
        return values
    size = np.abs(values)
    steps = 10.0 ** (np.floor(np.log10(np.where(size > 0.0, size, 1.0))) - digits + 1)
    return np.asarray(np.round(values / steps) * steps)


def logged(
    channels: Mapping[str, np.ndarray], logger: Logger, random: np.random.Generator
) -> tuple[np.ndarray, dict[str, np.ndarray]]:
    """Return stamps and channels, (m,) each, of what the logger did not lose."""
    count = len(next(iter(channels.values())))
    time, there = stamps(logger, count, random), kept(logger, count, random)
    return time[there], {n: rounded(v[there], logger.digits) for n, v in channels.items()}
