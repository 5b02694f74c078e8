"""A run in memory: one structured array a topic."""

from __future__ import annotations

from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np

from steering_bringup.bags.errors import BagError


@dataclass(frozen=True)
class Gap:
    """Ticks missing on a topic between two messages that are there."""

    topic: str
    after: int
    before: int
    missing: int

    def __str__(self) -> str:
        return f"{self.topic}: {self.missing} ticks missing between {self.after} and {self.before}"


@dataclass(repr=False)
class Trace:
    """What was recorded.

    topics: topic -> structured array (n,) with `stamp` (int64, ns), `tick` where the type has one,
    and the message's numeric fields by their name (nested: "pose.pose.position.x").
    payloads: topic -> (n, size) uint8, the recorded CDR bytes. opaque: topics whose messages have
    no fixed size, as bytes with their stamps. notes: what the reader had to say (damage, gaps).
    """

    topics: dict[str, np.ndarray] = field(default_factory=dict)
    payloads: dict[str, np.ndarray] = field(default_factory=dict)
    types: dict[str, str] = field(default_factory=dict)
    opaque: dict[str, list[tuple[int, bytes]]] = field(default_factory=dict)
    run: dict[str, Any] = field(default_factory=dict)
    gaps: list[Gap] = field(default_factory=list)
    notes: list[str] = field(default_factory=list)
    outcome: str = ""
    complete: bool = True
    path: Path | None = None

    @property
    def name(self) -> str:
        """A short name for tables and legends."""
        return self.path.name if self.path else "trace"

    def __repr__(self) -> str:
        state = "complete" if self.complete else "not complete"
        return f"Trace({self.name}: {self.message_count} messages, {state})"

    def __contains__(self, topic: str) -> bool:
        return topic in self.topics

    def __getitem__(self, topic: str) -> np.ndarray:
        try:
            return self.topics[topic]
        except KeyError:
            have = ", ".join(sorted(self.topics)) or "nothing"
            raise BagError(f"{self.name} has no topic {topic}; it has {have}") from None

    def column(self, topic: str, name: str) -> np.ndarray:
        """One field of a topic, (n,); BagError naming what there is if it is not there."""
        rows = self[topic]
        names = rows.dtype.names or ()
        if name not in names:
            raise BagError(f"{topic} has no field {name}; it has {', '.join(names)}")
        return rows[name]

    @property
    def message_count(self) -> int:
        """Messages of all topics."""
        fixed = sum(len(rows) for rows in self.topics.values())
        return fixed + sum(len(items) for items in self.opaque.values())

    @property
    def last_tick(self) -> int | None:
        """The last tick on any topic; None without any."""
        lasts = [
            int(rows["tick"][-1])
            for rows in self.topics.values()
            if len(rows) and "tick" in (rows.dtype.names or ())
        ]
        return max(lasts) if lasts else None


def find_gaps(topic: str, ticks: np.ndarray) -> list[Gap]:
    """Gaps in a topic's ticks; its own period (1, 10, ...) is the most frequent step."""
    if len(ticks) < 2:
        return []
    steps = np.diff(ticks.astype(np.int64))
    values, counts = np.unique(steps[steps > 0], return_counts=True)
    if not len(values):
        return []
    period = int(values[np.argmax(counts)])
    where = np.flatnonzero(steps > period)
    return [
        Gap(topic, int(ticks[k]), int(ticks[k + 1]), int(steps[k]) // period - 1) for k in where
    ]
