"""The rig's clock against this machine's: how it drifts, and how long a frame was on its way."""

from __future__ import annotations

WINDOW = 256
"""Frames of which the quickest is taken: a frame can be held up, never come early."""

SLACK = 1e-4
"""Drift that the quickest transit follows upwards, relative."""


class ClockOffset:
    """Offsets are this machine's clock at a frame's arrival less the rig's at its measurement."""

    def __init__(self) -> None:
        self.reset()

    def reset(self) -> None:
        """Take the next frame as the first."""
        self.quickest: float | None = None
        self.window: list[tuple[int, int]] = []
        self.first: tuple[int, int] | None = None
        self.last: tuple[int, int] | None = None
        self.rig_ns = 0

    def see(self, rig_ns: int, now_ns: int) -> int:
        """Take a frame; return by how much it came later than the quickest ones [ns]."""
        offset = now_ns - rig_ns
        slack = SLACK * max(rig_ns - self.rig_ns, 0)
        self.quickest = offset if self.quickest is None else min(self.quickest + slack, offset)
        self.rig_ns = rig_ns
        self.window.append((offset, rig_ns))
        if len(self.window) == WINDOW:
            self.last = min(self.window)
            self.first = self.first or self.last
            self.window.clear()
        return int(offset - self.quickest)

    def drift(self) -> float | None:
        """Return by how much the rig's clock is slow, relative; None while it is too early."""
        if self.first is None or self.last is None or self.last[1] <= self.first[1]:
            return None
        return (self.last[0] - self.first[0]) / (self.last[1] - self.first[1])
