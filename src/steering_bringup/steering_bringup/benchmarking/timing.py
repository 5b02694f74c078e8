"""Times that can be compared: taken in turns, so that a busy machine slows all of them alike."""

from __future__ import annotations

import statistics
import time
from collections.abc import Callable, Mapping, Sequence
from typing import Any


def seconds(call: Callable[[], Any]) -> float:
    """Return how long ``call`` takes [s]."""
    begin = time.perf_counter()
    call()
    return time.perf_counter() - begin


def in_turns(calls: Mapping[str, Callable[[], float]], repetitions: int) -> dict[str, list[float]]:
    """Return what each call measures, one after the other, ``repetitions`` times over."""
    found: dict[str, list[float]] = {name: [] for name in calls}
    for _ in range(repetitions):
        for name, call in calls.items():
            found[name].append(call())
    return found


def ratio(above: Sequence[float], below: Sequence[float]) -> float:
    """Return the median over the turns of ``above`` / ``below``."""
    return statistics.median(a / b for a, b in zip(above, below, strict=True))
