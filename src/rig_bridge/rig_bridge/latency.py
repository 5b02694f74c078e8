"""Latency of the bridge: from a measurement's arrival to its command on the wire."""

from __future__ import annotations

from collections import Counter

LATE_NS = 1_000_000
"""A command later than this after its measurement is late."""

STEP_NS = 1_000


class Latency:
    """Counts latencies in steps of 1 us, so that memory does not grow with the run."""

    def __init__(self) -> None:
        self.reset()

    def reset(self) -> None:
        """Begin to count again."""
        self.counts: Counter[int] = Counter()
        self.largest_ns = 0
        self.late = 0

    def add(self, latency_ns: int) -> None:
        """Take the latency of one tick."""
        self.counts[latency_ns // STEP_NS] += 1
        self.largest_ns = max(self.largest_ns, latency_ns)
        self.late += latency_ns > LATE_NS

    @property
    def ticks(self) -> int:
        """Number of latencies taken."""
        return self.counts.total()

    def percentile(self, share: float) -> float:
        """Return the latency [s] that ``share`` of the ticks do not exceed, to 1 us; 0 if none."""
        rank, passed = share * self.ticks, 0
        for step in sorted(self.counts):
            passed += self.counts[step]
            if passed >= rank:
                return min((step + 1) * STEP_NS, self.largest_ns) * 1e-9
        return 0.0

    def report(self) -> dict[str, float | int]:
        """Return p50, p99 and maximum [s], and how many ticks there were and were late."""
        p50, p99 = self.percentile(0.50), self.percentile(0.99)
        largest = self.largest_ns * 1e-9
        return {"p50": p50, "p99": p99, "max": largest, "ticks": self.ticks, "late": self.late}
