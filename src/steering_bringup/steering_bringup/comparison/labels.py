"""What two runs are called, and what must be said about them."""

from __future__ import annotations

import numpy as np

from steering_bringup.bags import Trace
from steering_bringup.comparison.signals import BY_KEY, SIGNALS, has, valve_system


def names_of(traces: tuple[Trace, Trace]) -> tuple[str, str]:
    """Labels of the runs: the valve systems if they differ, else the bags' own names."""
    systems = (valve_system(traces[0]), valve_system(traces[1]))
    if systems[0] != systems[1]:
        return systems
    names = (traces[0].name, traces[1].name)
    if names[0] == names[1]:
        names = (_with_folder(traces[0]), _with_folder(traces[1]))
    if names[0] != names[1]:
        return names
    return (f"{names[0]} (first)", f"{names[1]} (second)")


def _with_folder(trace: Trace) -> str:
    return trace.name if trace.path is None else f"{trace.path.resolve().parent.name}/{trace.name}"


def is_finite(
    key: str, pair: tuple[np.ndarray, np.ndarray], traces: tuple[Trace, Trace], notes: list[str]
) -> bool:
    """Whether a signal is finite in both runs; if not, it is left out, and that is said."""
    for trace, values in zip(traces, pair, strict=True):
        count = int(np.count_nonzero(~np.isfinite(values)))
        if count:
            title = BY_KEY[key].title.lower()
            notes.append(f"{trace.name}: {title} is left out, {count} values are not finite")
            return False
    return True


def missing_notes(traces: tuple[Trace, Trace]) -> list[str]:
    """Signals that a run does not hold, a line a run."""
    notes = []
    for trace in traces:
        missing = [s.title.lower() for s in SIGNALS if not has(trace, s)]
        if missing:
            notes.append(f"{trace.name} does not hold: {', '.join(missing)}")
    return notes
