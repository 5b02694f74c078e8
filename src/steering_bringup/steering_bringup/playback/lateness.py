"""How late messages left, as a histogram of fixed size. Pure."""

from __future__ import annotations

import numpy as np

BIN_NS = 10_000
BINS = 10_000


class Lateness:
    """Counts delays in bins of 10 us up to 0.1 s; later ones are in the last bin."""

    def __init__(self) -> None:
        self._bins = [0] * BINS
        self.count = 0
        self.largest = 0

    def add(self, nanoseconds: int) -> None:
        """Count one delay in ns; an early one is none."""
        late = max(nanoseconds, 0)
        self._bins[min(late // BIN_NS, BINS - 1)] += 1
        self.count += 1
        self.largest = max(self.largest, late)

    def percentile(self, share: float) -> float:
        """Return the delay in s that ``share`` (0 to 1) of all do not exceed, to 10 us."""
        if not self.count:
            return 0.0
        reached = int(np.searchsorted(np.cumsum(self._bins), share * self.count))
        return min((reached + 1) * BIN_NS, self.largest) * 1e-9

    def as_json(self) -> dict[str, float]:
        """Return p50, p99 and max in s."""
        p50, p99 = self.percentile(0.5), self.percentile(0.99)
        return {"p50": p50, "p99": p99, "max": self.largest * 1e-9}
