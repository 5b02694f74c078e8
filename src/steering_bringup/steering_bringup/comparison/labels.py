"""What two runs are called, and what must be said about them."""

from __future__ import annotations

import numpy as np

from steering_bringup.bags import Trace
from steering_bringup.comparison.signals import Signal, has, is_run, valve_system

MOST_NAMED = 16
"""Signals that a note names before it says how many more there are."""


def names_of(traces: tuple[Trace, Trace]) -> tuple[str, str]:
    """Labels of the runs: the valve systems if they differ, else the names of bags or files."""
    systems = (valve_system(traces[0]), valve_system(traces[1]))
    if systems[0] != systems[1] and all(is_run(trace) for trace in traces):
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
    signal: Signal,
    pair: tuple[np.ndarray, np.ndarray],
    traces: tuple[Trace, Trace],
    notes: list[str],
) -> bool:
    """Whether a signal is finite in both runs; if not, it is left out, and that is said."""
    for trace, values in zip(traces, pair, strict=True):
        count = int(np.count_nonzero(~np.isfinite(values)))
        if count:
            title = signal.title.lower()
            notes.append(f"{trace.name}: {title} is left out, {count} values are not finite")
            return False
    return True


def missing_notes(traces: tuple[Trace, Trace], kinds: list[Signal]) -> list[str]:
    """Signals that a run does not hold, a line a run; of other data, those that the other holds."""
    notes = []
    runs = all(is_run(trace) for trace in traces)
    for trace in traces:
        missing = [
            s.title.lower() if s.digits is not None else s.title
            for s in kinds
            if not has(trace, s) and (runs or any(has(other, s) for other in traces))
        ]
        if missing:
            more = len(missing) - MOST_NAMED
            shown = ", ".join(missing[:MOST_NAMED]) + (f" and {more} more" if more > 0 else "")
            notes.append(f"{trace.name} does not hold: {shown}")
    return notes
