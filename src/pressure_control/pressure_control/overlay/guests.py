"""Guests, the sources outside the lock step: how often each speaks, learnt from its messages.

Nobody tells the arbiter a guest's period. It is the middle one of the last few times between its
messages: one message that is lost or comes in a burst changes nothing, nor does a pause. A guest
of whom nothing is known counts as the fastest, so that it is the soonest to be taken for silent.
"""

from __future__ import annotations

from collections import deque

from pressure_control.limits import bounded

REMEMBERED = 5
"""Times between messages: two odd ones among them are outvoted."""


class Rhythm:
    """One guest's messages in time. ``shortest``, ``longest`` [ticks]: bounds of its period."""

    def __init__(self, shortest: float, longest: float) -> None:
        self.shortest, self.longest = shortest, longest
        self._last: int | None = None
        self._gaps: deque[int] = deque(maxlen=REMEMBERED)

    def hear(self, tick: int) -> None:
        """Note a message that came in before ``tick``; several before one tick are one."""
        if self._last is not None and tick > self._last:
            self._gaps.append(tick - self._last)
        self._last = tick

    @property
    def period(self) -> float:
        """Return the period [ticks]; of an even number of times the shorter middle one counts."""
        if not self._gaps:
            return self.shortest
        middle = sorted(self._gaps)[(len(self._gaps) - 1) // 2]
        return bounded(float(middle), self.shortest, self.longest)
