"""The node that is the clock: it publishes tick k, waits for its commands, and goes on."""

from __future__ import annotations

from collections.abc import Callable
from time import monotonic_ns
from typing import Any

import numpy as np

from steering_lockstep.clock_status import ClockStatus
from steering_lockstep.diagnostics import ERROR, OK, WARN, Diagnostics
from steering_lockstep.errors import LockstepError
from steering_lockstep.node import LockstepNode
from steering_lockstep.settings import CREDIT_TICKS
from steering_lockstep.topics import CREDIT, wire
from steering_lockstep.wire import NANOSECONDS_PER_TICK

TASK = "lock step"
"""What the clock's status on /diagnostics is called."""
BEHIND = "behind the wall clock"


class ClockNode(LockstepNode):
    """Base of the plant and of whatever takes its place.

    ``core.out`` is measured at tick 0; ``core.step(k, *commands)`` goes from tick k to k + 1 and
    returns what is measured there. ``sleep_until`` is given by whoever spins a real-time run:
    it must call ``resume()`` at that ``time.monotonic_ns``.
    """

    def __init__(self, *args: Any, **kwargs: Any) -> None:
        super().__init__(*args, **kwargs)
        self.has_recorder = CREDIT in self.run.graph.publisher
        self.credit = CREDIT_TICKS if self.has_recorder else self.run.ticks
        self.waits_for_credit = False
        self.started_at = 0
        self.ended_at = 0
        self.lateness = np.zeros(self.run.ticks if self.run.real_time else 0, np.int64)
        self.sleep_until: Callable[[int], None] = _no_pacing
        self.status = ClockStatus()
        self.diagnostics = Diagnostics(self, TASK)
        if self.has_recorder:
            self._subscribe(CREDIT, self._more_credit)

    @property
    def preparing(self) -> bool:
        """Whether the clock itself makes the nodes wait for tick 0."""
        return False

    def start(self) -> None:
        """Publish tick 0; called once when every endpoint is matched."""
        now = monotonic_ns()
        self.status.begin(now)
        self._tell_running(0, now)
        self.started_at = monotonic_ns()
        self.guarded(self._go)

    def resume(self) -> None:
        """Go on after a sleep of a real-time run."""
        self.guarded(self._go)

    def failed(self, error: LockstepError) -> None:
        """Tell others why the run ends."""
        self._tell_state(ERROR, str(error), self.barrier.tick, monotonic_ns())

    def lacking(self) -> tuple[str, ...]:
        """Return the topics that the node waits for, the recorder's credit among them."""
        return (CREDIT,) if self.waits_for_credit else super().lacking()

    def result(self) -> dict[str, Any]:
        """Return times in ns of the monotonic clock and, in real time, each tick's latency."""
        done = self.run.ticks if self.finished else self.barrier.tick
        times = {"started_at": self.started_at, "ended_at": self.ended_at, "ticks": done}
        return {**super().result(), **times, "lateness": self.lateness}

    def _go(self) -> None:
        """Publish the measurements of the present tick, and do ticks as long as nothing lacks."""
        while True:
            self.publish(self.barrier.tick, self.core.out.tolist())
            if self.barrier.missing or not self._integrate():
                return

    def _complete(self) -> None:
        """All commands of the tick are there: do it, and go on to the next."""
        if self._integrate():
            self._go()

    def _integrate(self) -> bool:
        """Go to the next tick with the commands of this one; return whether it may be published."""
        barrier = self.barrier
        tick = barrier.tick
        now = monotonic_ns()
        if self.run.real_time:
            self._note_lateness(tick, now)
        if now > self.diagnostics.due:
            self._tell_running(tick, now)
        if tick + 1 >= self.run.ticks:
            self.ended_at = now
            self._tell_state(OK, f"finished after {self.run.ticks} ticks", tick, now)
            self._finish()
            return False
        self.busy = True
        self.core.step(tick, *self._pick(barrier.values()))
        self.busy = False
        barrier.advance()
        return self._may_go_on()

    def _may_go_on(self) -> bool:
        if self.barrier.tick > self.credit:
            self.waits_for_credit = True
            return False
        if self.run.real_time and monotonic_ns() < self._due(self.barrier.tick):
            self.sleep_until(self._due(self.barrier.tick))
            return False
        return True

    def _note_lateness(self, tick: int, now: int) -> None:
        self.lateness[tick] = late = now - self._due(tick)
        self.status.note(late, now)
        if self.status.late_at == now and self.diagnostics.changed(WARN, BEHIND):
            self._tell_running(tick, now)

    def _tell_running(self, tick: int, now: int) -> None:
        behind = self.status.behind(now)
        self._tell_state(WARN if behind else OK, BEHIND if behind else "running", tick, now)

    def _tell_state(self, level: Any, text: str, tick: int, now: int) -> None:
        credit = self.credit if self.has_recorder else None
        self.diagnostics.tell(level, text, tick, self.status.values(tick, now, credit))

    def _due(self, tick: int) -> int:
        return self.started_at + tick * NANOSECONDS_PER_TICK

    def _more_credit(self, data: bytes) -> None:
        """The recorder has dealt with everything up to a tick."""
        (done,) = wire(CREDIT).unpack(data)
        self.credit = done + CREDIT_TICKS
        if self.waits_for_credit and self.barrier.tick <= self.credit:
            self.waits_for_credit = False
            if self._may_go_on():
                self._go()


def _no_pacing(due: int) -> None:
    raise RuntimeError(f"nobody paces this run (due at {due} ns)")
