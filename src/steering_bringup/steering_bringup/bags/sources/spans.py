"""Stretches of time in which a bag has messages, between silences that nobody would wait for."""

from __future__ import annotations

from collections.abc import Iterable

import numpy as np

Span = tuple[int, int]
"""ns of the first and the last message of a stretch."""

SILENCE_NS = 86_400 * 1_000_000_000
"""A longer silence divides two stretches: a clock was not set, or was set, in between."""


def spans_of(stamps: np.ndarray) -> list[Span]:
    """Return the stretches of rising ``stamps`` (n,) in ns."""
    if not len(stamps):
        return []
    # As unsigned numbers: from far before to far after is more than an int64 holds.
    steps = stamps[1:].astype(np.uint64) - stamps[:-1].astype(np.uint64)
    ends = np.flatnonzero(steps > SILENCE_NS)
    firsts = stamps[np.concatenate(([0], ends + 1))].tolist()
    lasts = stamps[np.concatenate((ends, [len(stamps) - 1]))].tolist()
    return list(zip(firsts, lasts, strict=True))


def joined(spans: Iterable[Span]) -> list[Span]:
    """Return the stretches of several files together."""
    made: list[Span] = []
    for first, last in sorted(spans):
        if made and first - made[-1][1] <= SILENCE_NS:
            made[-1] = (made[-1][0], max(made[-1][1], last))
        else:
            made.append((first, last))
    return made
