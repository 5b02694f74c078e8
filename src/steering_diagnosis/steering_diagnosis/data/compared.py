"""Any data as a trace on ticks of 1 ms, for the comparison: bags of all tools, and mapped files."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path

import numpy as np

from steering_bringup.bags import Trace, read_bag
from steering_bringup.comparison.signals import is_run
from steering_core.errors import BenchError
from steering_diagnosis.data.channels import CHANNELS
from steering_diagnosis.data.foreign import READERS
from steering_diagnosis.data.read import read_record
from steering_diagnosis.data.record import PERIOD_S, Record
from steering_diagnosis.data.resample import on_grid, sampled

NANOSECONDS_A_TICK = 1_000_000


def trace_of(path: Path, mapping: Path | None) -> Trace:
    """Return the trace of a bag, or of a CSV, MATLAB or MDF4 file with its ``mapping``.

    Raises BenchError: no such data, unreadable, no mapping for a file that needs one.
    """
    if path.suffix.lower() in READERS:
        return _of_record(read_record(path, mapping))
    trace = read_bag(path, repair_damage=False)
    if not trace.complete:
        trace.notes.append("read as far as it goes and left as it is; 'steer recover' repairs it")
    return trace if is_run(trace) else _on_ticks(trace)


def _of_record(record: Record) -> Trace:
    """Return a record as if it had been recorded: a row for each tick that has all of a topic."""
    fields: dict[str, dict[str, np.ndarray]] = {}
    for name, values in record.channels.items():
        channel = CHANNELS[name]
        fields.setdefault(channel.topic, {})[channel.field] = values
    measured = {"valve_system": record.valve_system, "sha256": record.sha256}
    return Trace(
        topics={topic: _rows(0, named) for topic, named in fields.items()},
        run={"measured": measured},
        notes=[*record.notes, "its time counts from its own beginning"],
        path=record.path,
    )


def _on_ticks(trace: Trace) -> Trace:
    """Return a bag of another tool with its numbers on ticks; those that have ticks keep them."""
    topics, notes = {}, list(trace.notes)
    zero = _zero(trace)
    moved = False
    for topic, rows in trace.topics.items():
        names = rows.dtype.names or ()
        if "tick" in names:
            topics[topic] = rows
            continue
        named = _resampled(topic, rows, zero, notes)
        if not named:
            continue
        first = min(first for first, _ in named.values())
        topics[topic] = _rows(first, {name: values for name, (_, values) in named.items()})
        moved = True
    if moved:
        notes.append(
            "its topics without ticks are taken by their time from the bag's beginning, between "
            "messages linearly"
        )
    # Without payloads: what is resampled is never the same to the bit.
    return replace(trace, topics=topics, payloads={}, notes=notes)


def _resampled(
    topic: str, rows: np.ndarray, zero: int, notes: list[str]
) -> dict[str, tuple[int, np.ndarray]]:
    """Return a topic's fields as (first tick, values); what cannot be used is noted."""
    time = (rows["stamp"].astype(np.int64) - zero) * 1e-9
    first = int(np.ceil(time.min() / PERIOD_S - 1e-6))
    count = int(np.floor(time.max() / PERIOD_S + 1e-6)) - first + 1
    found = {}
    for name in rows.dtype.names or ():
        if name == "stamp" or rows.dtype[name].shape:
            continue
        try:
            channel = sampled(f"{topic} {name}", time, rows[name].astype(np.float64))
        except BenchError as error:
            notes.append(f"left out: {error}")
            continue
        notes += [note for note in channel.findings if "constant" not in note]
        found[name] = (first, on_grid(channel, first * PERIOD_S, count))
    return found


def _zero(trace: Trace) -> int:
    """Return the stamp [ns] of tick 0: by a topic that has ticks, else the first stamp of all."""
    for rows in trace.topics.values():
        if len(rows) and "tick" in (rows.dtype.names or ()):
            return int(rows["stamp"][0]) - int(rows["tick"][0]) * NANOSECONDS_A_TICK
    return min((int(rows["stamp"].min()) for rows in trace.topics.values() if len(rows)), default=0)


def _rows(first: int, fields: Mapping[str, np.ndarray]) -> np.ndarray:
    """Return rows (k,) of the ticks from ``first`` on at which every field is a number."""
    there = np.all([np.isfinite(values) for values in fields.values()], axis=0)
    ticks = first + np.flatnonzero(there)
    dtype = [("stamp", "<i8"), ("tick", "<i8"), *((name, "<f8") for name in fields)]
    rows = np.empty(len(ticks), np.dtype(dtype))
    rows["tick"], rows["stamp"] = ticks, ticks * NANOSECONDS_A_TICK
    for name, values in fields.items():
        rows[name] = values[there]
    return rows
