"""How often a channel may be wrong for a sample: a budget in a sliding window, and what counts."""

from __future__ import annotations

from collections import deque

BACK_TICKS = 8
"""A change that is taken back within so many ticks counts; no oil, rack or wheel turns so fast."""


class SampleBudget:
    """At most ``most`` bad samples in any ``window`` ticks."""

    def __init__(self, most: int, window: int) -> None:
        self.most = most
        self.window = window
        self.reset()

    def reset(self) -> None:
        """Forget the past."""
        self.tick = 0
        self.at: deque[int] = deque(maxlen=self.most + 1)

    def pass_ticks(self, ticks: int) -> None:
        """Let time go by."""
        self.tick += ticks

    def count(self) -> bool:
        """Take a bad sample of this tick; return whether the budget is exceeded."""
        self.at.append(self.tick)
        return len(self.at) > self.most and self.tick - self.at[0] < self.window

    @property
    def since(self) -> int:
        """Ticks from the oldest of the samples that are remembered to this one, both counted."""
        return self.tick - self.at[0] + 1


class JumpWatch:
    """Finds samples that do not go with those around: a jump that is taken back at once.

    A single wrong sample is one, a burst of up to ``BACK_TICKS`` too, and alternation is one in
    each tick. A step or a steep slope is none. jump: least change in a tick that counts, SI.
    """

    def __init__(self, jump: float) -> None:
        self.jump = jump
        self.reset()

    def reset(self) -> None:
        """Take the next sample as the first."""
        self.last: float | None = None
        self.upward = False
        self.ago = BACK_TICKS

    def see(self, value: float, steps: int) -> float | None:
        """Take a sample, ``steps`` ticks after the last; return a change that takes one back."""
        change = 0.0 if self.last is None else value - self.last
        self.last = value
        self.ago += steps
        if abs(change) <= self.jump * steps:
            return None
        upward = change > 0.0
        back = upward is not self.upward and self.ago <= BACK_TICKS
        self.upward, self.ago = upward, 0
        return change if back else None
