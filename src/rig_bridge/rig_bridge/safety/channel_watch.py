"""Watches one measured channel: a number, within range, not too fast, not frozen, not spoilt."""

from __future__ import annotations

from math import isfinite

from rig_bridge.channels import Channel
from rig_bridge.safety.bad_samples import JumpWatch, SampleBudget
from rig_bridge.safety.faults import Fault, Kind
from rig_bridge.signals import PERIOD_S
from rig_bridge.watching import Watching

JUMP_SHARE = 0.25
"""Of what ``rate`` allows in a tick; nothing goes back by a fifth of it in a shipped manoeuvre."""


class ChannelWatch:
    """``good`` is the last value that may be used: a single bad sample is bridged, not passed on.

    As many bad samples in a row as ``confirm_ticks`` are a fault, and so are more than the budget
    in a sliding window, in whatever pattern; samples that jump there and back count as well,
    though they may be used. ``good`` is finite and within the channel's range at any time.
    """

    def __init__(self, name: str, channel: Channel, watching: Watching) -> None:
        self.name = name
        self.channel = channel
        self.confirm_ticks = watching.confirm_ticks
        own = channel.bridged_samples
        most = watching.bridged_samples if own is None else own
        self.budget = SampleBudget(max(most, self.confirm_ticks - 1), watching.bridged_window_ticks)
        self.jumps = JumpWatch(channel.jump or JUMP_SHARE * channel.rate * PERIOD_S)
        self.bridged = 0
        low, high = channel.range
        self.good = min(max(0.0, low), high)
        self.reset()

    def reset(self) -> None:
        """Take the next sample as the first."""
        self.seen: float | None = None
        self.since_good: int | None = None
        self.bad = 0
        self.repetitions = 0
        self.changed = False
        self.budget.reset()
        self.jumps.reset()

    def see(self, value: float, steps: int = 1) -> Fault | None:
        """Take the value of a frame, ``steps`` ticks after the last; return a confirmed fault."""
        self._note_repetition(value)
        if self.since_good is not None:
            self.since_good += steps
        self.budget.pass_ticks(steps)
        wrong = self._wrong(value)
        if wrong is None:
            back = self.jumps.see(value, self.since_good or 0)
            self.good, self.since_good, self.bad = value, 0, 0
            text = "" if back is None else f"{back:+g} {self.channel.unit} back and forth"
            return self._frozen() or (self._count(text) if text else None)
        self.bad += 1
        self.bridged += 1
        over = self._count(wrong.kind.value)
        return wrong if self.bad >= self.confirm_ticks else over

    def is_plausible(self) -> bool:
        """Return whether the present value is one that a rig at rest shows."""
        low, high = self.channel.plausible or self.channel.range
        return self.bad == 0 and self.since_good == 0 and low <= self.good <= high

    def is_alive(self) -> bool:
        """Return whether the value has moved since the reset, where a sensor's noise moves it."""
        return self.changed or self.channel.frozen_ticks == 0

    def _count(self, what: str) -> Fault | None:
        """Take a bad sample; return the fault that one too many is."""
        if not self.budget.count():
            return None
        budget = self.budget
        text = f"{len(budget.at)} in {budget.since} ms, the last: {what}"
        return Fault(Kind.BAD_SAMPLES, self.name, text)

    def _note_repetition(self, value: float) -> None:
        same = value == self.seen
        self.repetitions = self.repetitions + 1 if same else 0
        self.changed = self.changed or not (same or self.seen is None)
        self.seen = value

    def _wrong(self, value: float) -> Fault | None:
        low, high = self.channel.range
        if not isfinite(value):
            return Fault(Kind.NOT_FINITE, self.name, f"{value}")
        if not low <= value <= high:
            text = f"{value:g} {self.channel.unit}, range {low:g} to {high:g}"
            return Fault(Kind.RANGE, self.name, text)
        if self.since_good is not None:
            allowed = self.channel.rate * PERIOD_S * self.since_good
            if abs(value - self.good) > allowed:
                text = f"{value - self.good:+g} {self.channel.unit} in {self.since_good} ms"
                return Fault(Kind.RATE, self.name, f"{text}, at most {allowed:g}")
        return None

    def _frozen(self) -> Fault | None:
        if self.channel.frozen_ticks and self.repetitions >= self.channel.frozen_ticks:
            text = f"{self.seen:g} {self.channel.unit} for {self.repetitions + 1} samples"
            return Fault(Kind.FROZEN, self.name, text)
        return None
