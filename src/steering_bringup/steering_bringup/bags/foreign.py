"""Bags that are not ours as traces: of any storage, compression and number of files."""

from __future__ import annotations

from collections.abc import Container
from contextlib import closing
from pathlib import Path

import numpy as np

from steering_bringup.bags.definitions import typestore_of
from steering_bringup.bags.messages import add_opaque, add_rows
from steering_bringup.bags.sources import TopicInfo, open_bag
from steering_bringup.bags.trace import Trace


def read_foreign(path: Path, topics: Container[str] | None = None) -> Trace:
    """Read a bag message by message; BagError if there is nothing in it.

    The channels of a topic are joined in order of time. What is left out is in the trace's notes.
    """
    with closing(open_bag(path)) as bag:
        known = {label: info for label, info in bag.topics.items() if info.count}
        wanted = {n: info for n, info in known.items() if topics is None or n in topics}
        stamps: dict[str, list[int]] = {name: [] for name in wanted}
        payloads: dict[str, list[bytes]] = {name: [] for name in wanted}
        for stamp, name, data in bag.messages(wanted):
            stamps[name].append(stamp)
            payloads[name].append(data)
        trace = Trace(path=path, notes=bag.notes, complete=not bag.is_damaged)
    for name, info in wanted.items():
        trace.types[name] = info.msgtype
        _add(trace, name, info, np.array(stamps[name], np.int64), payloads[name])
    trace.notes += [
        f"{info.name}: {info.count} messages of {info.msgtype or 'no type'} are left out"
        for label, info in known.items()
        if label not in wanted and topics is not None and info.name in topics
    ]
    return trace


def _add(trace: Trace, name: str, info: TopicInfo, stamps: np.ndarray, items: list[bytes]) -> None:
    if info.encoding != "cdr" or len({len(item) for item in items}) != 1:
        add_opaque(trace, name, stamps, items)
        return
    rows = np.frombuffer(b"".join(items), np.uint8).reshape(len(items), -1)
    store = typestore_of({info.msgtype: info.definition} if info.msgtype else {})
    add_rows(trace, name, info.msgtype, store, stamps, rows)
