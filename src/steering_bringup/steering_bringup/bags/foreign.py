"""Bags that are not ours: everything that rosbags can open."""

from __future__ import annotations

from collections.abc import Container
from pathlib import Path

import numpy as np
from rosbags.highlevel import AnyReader, AnyReaderError
from rosbags.rosbag2 import ReaderError
from rosbags.typesys import Stores, get_typestore

from steering_bringup.bags.errors import BagError
from steering_bringup.bags.messages import add_opaque, add_rows
from steering_bringup.bags.trace import Trace


def read_foreign(path: Path, topics: Container[str] | None = None) -> Trace:
    """Read a bag through rosbags, message by message; BagError if it cannot be opened."""
    stamps: dict[str, list[int]] = {}
    payloads: dict[str, list[bytes]] = {}
    trace = Trace(path=path)
    default = get_typestore(Stores.ROS2_JAZZY)
    try:
        with AnyReader([path], default_typestore=default) as reader:
            wanted = [c for c in reader.connections if topics is None or c.topic in topics]
            for connection, stamp, data in reader.messages(wanted) if wanted else ():
                trace.types[connection.topic] = connection.msgtype
                stamps.setdefault(connection.topic, []).append(stamp)
                payloads.setdefault(connection.topic, []).append(bytes(data))
            store = reader.typestore
    except (AnyReaderError, ReaderError, OSError, AssertionError) as error:
        raise BagError(f"'{path}' cannot be read: {error}") from error
    for topic, items in payloads.items():
        times = np.array(stamps[topic], np.int64)
        if len({len(item) for item in items}) == 1:
            rows = np.frombuffer(b"".join(items), np.uint8).reshape(len(items), -1)
            add_rows(trace, topic, trace.types[topic], store, times, rows)
        else:
            add_opaque(trace, topic, times, items)
    return trace
