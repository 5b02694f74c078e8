"""Watches the rig's clock: against its own sequence numbers, and against this machine's clock."""

from __future__ import annotations

from collections import deque

from rig_bridge.safety.faults import Fault, Kind
from rig_bridge.signals import PERIOD_S
from rig_bridge.watching import Watching

PERIOD_NS = round(PERIOD_S * 1e9)
WINDOW = 4
"""Frames of which the quickest tells the offset: a frame can be held up, never come early."""


class ClockWatch:
    """Steps at once; drift once its offset exceeds what the allowed drift explains."""

    def __init__(self, watching: Watching) -> None:
        self.watching = watching
        self.reset()

    def reset(self) -> None:
        """Take the next frame as the first."""
        self.rig_ns: int | None = None
        self.offsets: deque[int] = deque(maxlen=WINDOW)
        self.followed = 0.0

    def see(self, rig_ns: int, steps: int, now_ns: int | None = None) -> Fault | None:
        """Return what is wrong with the clock at a new frame, ``steps`` periods after the last.

        now_ns: this machine's clock if the frame has just come, None if others came after it.
        """
        jump = 0 if self.rig_ns is None else rig_ns - self.rig_ns - steps * PERIOD_NS
        self.rig_ns = rig_ns
        if abs(jump) > self.watching.clock_step_s * 1e9:
            return Fault(Kind.CLOCK_STEP, None, f"by {jump * 1e-6:+.3f} ms")
        return None if now_ns is None else self._drift(now_ns - rig_ns, steps)

    def _drift(self, offset: int, steps: int) -> Fault | None:
        self.offsets.append(offset)
        quickest = min(self.offsets)
        if len(self.offsets) < WINDOW:
            self.followed = float(quickest)
            return None
        reach = self.watching.clock_drift * steps * PERIOD_NS
        self.followed += min(max(quickest - self.followed, -reach), reach)
        away = quickest - self.followed
        if abs(away) > self.watching.clock_offset_s * 1e9:
            return Fault(Kind.CLOCK_DRIFT, None, f"{away * 1e-6:+.3f} ms beyond the allowed drift")
        return None
