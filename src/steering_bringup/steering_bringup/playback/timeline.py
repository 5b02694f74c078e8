"""Recording time to wall-clock time, with pauses and changes of rate. Pure."""

from __future__ import annotations

from math import isinf


class Timeline:
    """When a message is due: every deadline counts from the beginning, so nothing adds up.

    ``rate``: seconds of recording in a second of wall clock; infinite: everything is due at once.
    All times in ns. ``wall`` is a monotonic clock.
    """

    def __init__(self, rate: float) -> None:
        self.rate = rate
        self._wall = 0
        self._recorded = 0
        self._paused_at: int | None = None

    @property
    def paused(self) -> bool:
        """Whether time stands still."""
        return self._paused_at is not None

    def start(self, wall: int, recorded: int) -> None:
        """Let ``recorded`` be due at ``wall``; a pause goes on from there."""
        self._wall, self._recorded = wall, recorded
        if self._paused_at is not None:
            self._paused_at = wall

    def due(self, recorded: int) -> int:
        """Return the wall-clock time at which ``recorded`` is due, if there is no pause."""
        if isinf(self.rate):
            return self._wall
        return self._wall + round((recorded - self._recorded) / self.rate)

    def pause(self, wall: int) -> None:
        """Stop the time, or let it go on: what is due waits as long as the pause took."""
        if self._paused_at is None:
            self._paused_at = wall
        else:
            self._wall += wall - self._paused_at
            self._paused_at = None

    def set_rate(self, wall: int, rate: float) -> None:
        """Go on from the present place at another rate."""
        wall = wall if self._paused_at is None else self._paused_at
        if not isinf(self.rate):
            self._recorded += round((wall - self._wall) * self.rate)
            self._wall = wall
            self.rate = rate
