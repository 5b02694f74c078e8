"""Bit equality of two traces."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np

from steering_bringup.bags.trace import Trace


@dataclass(frozen=True)
class Difference:
    """The first place where two traces part. Values are text, with the bits where they help."""

    topic: str
    tick: int | None
    field: str
    left: str
    right: str

    def __str__(self) -> str:
        where = self.topic if self.tick is None else f"{self.topic} at tick {self.tick}"
        return f"{where}, {self.field}: {self.left} against {self.right}"


def first_difference(
    left: Trace, right: Trace, topics: Iterable[str] | None = None
) -> Difference | None:
    """First difference (earliest tick) of the recorded bytes of two traces; None if equal.

    All topics of both are compared, or only `topics`. Log times are not part of it.
    """
    names = sorted(set(topics) if topics is not None else _names(left) | _names(right))
    found = [d for name in names if (d := _compare_topic(name, left, right)) is not None]
    return min(found, key=lambda d: -1 if d.tick is None else d.tick, default=None)


def _names(trace: Trace) -> set[str]:
    return set(trace.topics) | set(trace.opaque)


def _compare_topic(topic: str, left: Trace, right: Trace) -> Difference | None:
    sides = [topic in _names(trace) for trace in (left, right)]
    if not all(sides):
        words = ["there" if side else "missing" for side in sides]
        return Difference(topic, None, "topic", words[0], words[1])
    if topic in left.payloads and topic in right.payloads:
        return _compare_rows(topic, left, right)
    return _compare_opaque(topic, left, right)


def _compare_rows(topic: str, left: Trace, right: Trace) -> Difference | None:
    a, b = left.payloads[topic], right.payloads[topic]
    if a.shape[1] != b.shape[1]:
        sizes = [f"{p.shape[1]} bytes a message" for p in (a, b)]
        return Difference(topic, None, "size", sizes[0], sizes[1])
    count = min(len(a), len(b))
    rows = np.flatnonzero(np.any(a[:count] != b[:count], axis=1))
    if len(rows):
        return _first_field(topic, int(rows[0]), left, right)
    if len(a) != len(b):
        longer = left if len(a) > len(b) else right
        return Difference(
            topic, _tick(longer, topic, count), "count", f"{len(a)} messages", f"{len(b)} messages"
        )
    return None


def _first_field(topic: str, row: int, left: Trace, right: Trace) -> Difference:
    a, b = left.topics[topic][row], right.topics[topic][row]
    tick = _tick(left, topic, row)
    if a.dtype == b.dtype:
        for name in a.dtype.names or ():
            if a[name].tobytes() != b[name].tobytes():
                return Difference(topic, tick, name, _value(a[name]), _value(b[name]))
    return Difference(
        topic,
        tick,
        "bytes outside the numeric fields",
        left.payloads[topic][row].tobytes().hex(),
        right.payloads[topic][row].tobytes().hex(),
    )


def _compare_opaque(topic: str, left: Trace, right: Trace) -> Difference | None:
    a, b = ([data for _, data in _bytes_of(t, topic)] for t in (left, right))
    for k, (x, y) in enumerate(zip(a, b, strict=False)):
        if x != y:
            return Difference(topic, None, f"message {k}", x.hex(), y.hex())
    if len(a) != len(b):
        return Difference(topic, None, "count", f"{len(a)} messages", f"{len(b)} messages")
    return None


def _bytes_of(trace: Trace, topic: str) -> list[tuple[int, bytes]]:
    if topic in trace.opaque:
        return trace.opaque[topic]
    stamps = trace.topics[topic]["stamp"].tolist()
    return [(t, p.tobytes()) for t, p in zip(stamps, trace.payloads[topic], strict=True)]


def _tick(trace: Trace, topic: str, row: int) -> int | None:
    rows = trace.topics[topic]
    return int(rows["tick"][row]) if "tick" in (rows.dtype.names or ()) else None


def _value(value: np.generic) -> str:
    if isinstance(value, np.floating):
        return f"{value!r} ({float(value).hex()})"
    return str(value)
