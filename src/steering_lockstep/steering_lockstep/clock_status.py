"""How a run is going, in numbers for /diagnostics. Pure."""

from __future__ import annotations

from steering_lockstep.settings import CREDIT_TICKS
from steering_lockstep.wire import NANOSECONDS_PER_TICK

CALM = 1_000_000_000
"""ns without a late tick until a clock in real time no longer counts as behind."""
SPAN = 500_000_000
"""ns over which a pace means something; a change may be told sooner, without one."""


class ClockStatus:
    """The pace since it was told last, and whether the wall clock is kept up with."""

    def __init__(self) -> None:
        self.late_at: int | None = None
        self.latest = 0
        self._since = (0, 0)

    def begin(self, now: int) -> None:
        """Note that tick 0 is published at ``now`` [ns]."""
        self._since = (0, now)

    def note(self, late: int, now: int) -> None:
        """Note by how much [ns] a tick of a real-time run was done after it began."""
        self.latest = max(self.latest, late)
        if late > NANOSECONDS_PER_TICK:
            self.late_at = now

    def behind(self, now: int) -> bool:
        """Return whether a tick took longer than its time within the last second."""
        return self.late_at is not None and now - self.late_at < CALM

    def values(self, tick: int, now: int, credit: int | None) -> dict[str, str]:
        """Return the numbers at ``tick``, and begin to count anew; the pace where it is known.

        credit: tick up to which the recorder lets the clock go; None where nothing is recorded.
        """
        found = {"tick": str(tick), "largest_lateness_ms": f"{self.latest * 1e-6:.3f}"}
        self.latest = 0
        before, then = self._since
        if now - then >= SPAN:
            pace = (tick - before) * NANOSECONDS_PER_TICK / (now - then)
            found["real_time_factor"] = f"{pace:.3f}"
            self._since = (tick, now)
        if credit is not None:
            found["recorder_queue_ticks"] = str(max(tick - (credit - CREDIT_TICKS), 0))
        return found
