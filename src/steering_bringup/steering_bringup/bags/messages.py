"""From recorded payloads to structured rows."""

from __future__ import annotations

import numpy as np
from rosbags.typesys.store import Typestore

from steering_bringup.bags.layout import layout_of
from steering_bringup.bags.trace import Trace, find_gaps


def add_rows(
    trace: Trace,
    topic: str,
    msgtype: str,
    store: Typestore,
    log_times: np.ndarray,
    payloads: np.ndarray,
) -> None:
    """Add a topic whose payloads (n, size) have one size; opaque if its layout is not fixed."""
    if not len(payloads):
        return
    layout = layout_of(msgtype, store, payloads[0].tobytes()) if msgtype else None
    if layout is None or not layout.fits(payloads):
        add_opaque(trace, topic, log_times, [row.tobytes() for row in payloads])
        return
    rows = columns(layout.rows(payloads), log_times)
    trace.topics[topic] = rows
    trace.payloads[topic] = payloads
    if "tick" in (rows.dtype.names or ()):
        trace.gaps += (gaps := find_gaps(topic, rows["tick"]))
        trace.notes += [str(gap) for gap in gaps[:5]]
        if not bool(np.all(rows["tick"][1:] > rows["tick"][:-1])):
            trace.notes.append(f"{topic}: ticks repeat or run backwards")


def add_opaque(trace: Trace, topic: str, log_times: np.ndarray, payloads: list[bytes]) -> None:
    """Add a topic whose messages are kept as bytes."""
    trace.opaque[topic] = [(int(t), p) for t, p in zip(log_times, payloads, strict=True)]


def columns(rows: np.ndarray, log_times: np.ndarray) -> np.ndarray:
    """Packed copy of the numeric fields, with `stamp` in ns first.

    The stamp is the header's, and the recording's for a type without a header.
    """
    names = [n for n in rows.dtype.names or () if rows.dtype[n].base.kind in "iufb"]
    kept = [n for n in names if not n.startswith("header.")]
    fields = [("stamp", "<i8")] + [(n, rows.dtype[n]) for n in kept if n != "stamp"]
    packed = np.empty(len(rows), np.dtype(fields))
    for name in packed.dtype.names or ():
        if name != "stamp":
            packed[name] = rows[name]
    if "header.stamp.sec" in names:
        packed["stamp"] = rows["header.stamp.sec"].astype(np.int64) * 10**9
        packed["stamp"] += rows["header.stamp.nanosec"]
    else:
        packed["stamp"] = log_times
    return packed
