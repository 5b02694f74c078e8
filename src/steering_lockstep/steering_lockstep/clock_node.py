"""The node that is the clock: it publishes tick k, waits for its commands, and goes on."""

from __future__ import annotations

from collections.abc import Callable
from time import monotonic_ns
from typing import Any

import numpy as np

from steering_lockstep.diagnostics import ERROR, OK, WARN, Diagnostics
from steering_lockstep.errors import LockstepError
from steering_lockstep.node import LockstepNode
from steering_lockstep.settings import CREDIT_TICKS
from steering_lockstep.topics import CREDIT, wire
from steering_lockstep.wire import NANOSECONDS_PER_TICK


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
        self.diagnostics = Diagnostics(self, self.spec.name)
        if self.has_recorder:
            self._subscribe(CREDIT, self._more_credit)

    @property
    def preparing(self) -> bool:
        """Whether the clock itself makes the nodes wait for tick 0."""
        return False

    def start(self) -> None:
        """Publish tick 0; called once when every endpoint is matched."""
        self.diagnostics.tell(OK, "running", 0)
        self.started_at = monotonic_ns()
        self.guarded(self._go)

    def resume(self) -> None:
        """Go on after a sleep of a real-time run."""
        self.guarded(self._go)

    def failed(self, error: LockstepError) -> None:
        """Tell others why the run ends."""
        self.diagnostics.tell(ERROR, str(error), self.barrier.tick)

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
        if self.run.real_time:
            self._note_lateness(tick)
        if tick + 1 >= self.run.ticks:
            self.ended_at = monotonic_ns()
            self.diagnostics.tell(OK, f"finished after {self.run.ticks} ticks", tick)
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

    def _note_lateness(self, tick: int) -> None:
        late = monotonic_ns() - self._due(tick)
        self.lateness[tick] = late
        if late > NANOSECONDS_PER_TICK:
            self.diagnostics.tell(WARN, "behind the wall clock", tick)
        else:
            self.diagnostics.tell(OK, "running", tick)

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
