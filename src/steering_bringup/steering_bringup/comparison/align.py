"""Two runs on the same ticks. Nothing is interpolated: a tick is compared with the same tick."""

from __future__ import annotations

from collections.abc import Iterable
from functools import reduce

import numpy as np

from steering_bringup.bags import BagError, Trace

SECONDS_PER_TICK = 1e-3


def common_ticks(traces: Iterable[Trace], topics: Iterable[str]) -> np.ndarray:
    """Ticks (n,) int64 that every one of `topics` has in every trace; BagError if none."""
    traces, topics = list(traces), list(topics)
    sets = [
        np.unique(trace[topic]["tick"].astype(np.int64)) for trace in traces for topic in topics
    ]
    if not sets:
        raise BagError(f"{' and '.join(t.name for t in traces)} share no signal to compare")
    ticks = reduce(np.intersect1d, sets)
    if not len(ticks):
        raise BagError(f"{' and '.join(t.name for t in traces)} share no tick")
    return np.asarray(ticks)


def rows_at(trace: Trace, topic: str, ticks: np.ndarray) -> np.ndarray:
    """Rows of a topic at `ticks`, all of which it has."""
    rows = trace[topic]
    own = rows["tick"].astype(np.int64)
    if np.array_equal(own, ticks):
        return rows
    order = np.argsort(own, kind="stable")
    return rows[order[np.searchsorted(own[order], ticks)]]


def range_note(traces: Iterable[Trace], topic: str, ticks: np.ndarray) -> str:
    """What was left out to get to common ticks; empty if nothing."""
    lines = []
    for trace in traces:
        own = trace[topic]["tick"]
        left = len(own) - len(ticks)
        if left > 0:
            lines.append(f"{trace.name} has {left} ticks more ({own[0]} to {own[-1]})")
    if not lines:
        return ""
    return f"compared on the common ticks {ticks[0]} to {ticks[-1]}: " + "; ".join(lines)
