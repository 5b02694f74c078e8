"""A clock that nobody can hold up: hardware gives the ticks, and a late node is not waited for."""

from __future__ import annotations

from time import monotonic_ns
from typing import Any

from rclpy.task import Future

from steering_lockstep.clock_node import ClockNode
from steering_lockstep.diagnostics import ERROR, OK, WARN
from steering_lockstep.errors import LockstepError
from steering_lockstep.held import Held
from steering_lockstep.outside import Outside, Status
from steering_lockstep.settings import CREDIT_TICKS
from steering_lockstep.topics import CREDIT, wire

LEVELS = {"ok": OK, "warn": WARN, "error": ERROR}


class FreeClock(ClockNode):
    """Publishes a tick whenever the hardware begins one, and answers it before the next.

    The commands of the tick are sent as soon as they are all there, at ``answer_by`` at the latest:
    then the last values are held. Of ticks that came together each has its own answer, as far as
    there is time. What only a recorder reads is published after that. ``core`` is
    an ``Outside``.
    """

    collector = Held
    barrier: Held
    core: Outside

    def __init__(self, *args: Any, **kwargs: Any) -> None:
        super().__init__(*args, **kwargs)
        self.begun = False
        self.answered = True
        self.ahead = 0
        self.told: Status | None = None
        self.complete = Future()

    @property
    def preparing(self) -> bool:
        """Whether tick 0 has yet to come, through no fault of a node."""
        return not self.begun

    def start(self) -> None:
        """Open the hardware; called once when every endpoint is matched."""
        self.diagnostics.hardware = str(self.core.report().get("rig", self.diagnostics.hardware))
        self.guarded(self.core.open)
        self.sleep_until(0)

    def resume(self) -> None:
        """Do a turn, and ask for the next."""
        self.guarded(self._turn)
        if not self.finished:
            self.sleep_until(0)

    def result(self) -> dict[str, Any]:
        """Return the hardware's report beside the times."""
        return {**super().result(), "rig": self.core.report()}

    def close(self) -> None:
        """Leave the hardware safe."""
        self.core.close()
        self._tell()

    def _turn(self) -> None:
        rows = self.core.receive(self._left())
        with self.outbox.held():
            for begun, row in enumerate(rows, 1):
                self._begin(row)
                self._await(len(rows) - begun)
            if not rows:
                self._answer()
        self._after()

    def _left(self) -> int:
        """Return how many ticks of the run have yet to begin."""
        return self.run.ticks - (self.barrier.tick + 1 if self.begun else 0)

    def _await(self, ahead: int) -> None:
        """Answer the tick as soon as its commands are there, the last of a turn in any case."""
        self.answered, self.ahead = False, ahead
        if self.barrier.missing:
            self._serve(self.core.answer_by)
        if not self.answered and not (ahead and self.barrier.missing):
            self._answer()

    def _begin(self, row: tuple[float, ...]) -> None:
        """Publish the next tick; none is left out, however late the nodes are."""
        if self.finished:
            return
        if self.begun:
            self.barrier.advance()
        else:
            self.begun, self.started_at = True, monotonic_ns()
            self.status.begin(self.started_at)
        self.publish(self.barrier.tick, row)

    def _complete(self) -> None:
        """All commands of the tick are there; those of an earlier turn came too late for it."""
        if not self.answered:
            self._answer()
            self.complete.set_result(None)

    def _answer(self) -> None:
        self.answered = True
        barrier = self.barrier
        age = barrier.age() if self.begun else 0
        late = self._debtor() if age else None
        self.core.answer(barrier.tick, barrier.values(), age, late, self.ahead)

    def _debtor(self) -> str:
        """Return what is furthest behind, with its node."""
        name = self.barrier.oldest() or ""
        return f"{name} of node '{self.run.graph.publisher[name]}'"

    def _after(self) -> None:
        """What is left of the period: end, errors, diagnostics, and whatever else has come in."""
        if self.core.failure is not None:
            tick = self.barrier.tick if self.begun else None
            raise LockstepError("rig", self.spec.name, None, tick, self.core.failure)
        if self.has_recorder and self.barrier.tick > self.credit + CREDIT_TICKS:
            text = f"the recorder is {self.barrier.tick - self.credit + CREDIT_TICKS} ticks behind"
            recorder = self.run.graph.publisher[CREDIT]
            raise LockstepError("record", recorder, CREDIT, self.barrier.tick, text)
        if not self._left():
            self.ended_at = monotonic_ns()
            self.core.close()
            self._tell()
            self._finish()
            return
        self._serve(0)
        self._tell_if_due()

    def _serve(self, until: int) -> None:
        """Let the executor work until ``complete`` or a time; at least what is there already."""
        if self.complete.done():
            self.complete = Future()
        seconds = max(until - monotonic_ns(), 0) * 1e-9
        executor: Any = self.executor
        executor.spin_until_future_complete(self.complete, timeout_sec=seconds)

    def _tell_if_due(self) -> None:
        if self.core.status() != self.told or monotonic_ns() > self.diagnostics.due:
            self._tell()

    def _tell(self) -> None:
        status = self.told = self.core.status()
        tick = self.barrier.tick if self.begun else 0
        values = {"tick": tick, "guard": status.text, **self.core.numbers()}
        self.diagnostics.tell(LEVELS[status.level], status.text, tick, values)

    def failed(self, error: LockstepError) -> None:
        """Tell others why the run ends, and make the hardware safe before anything else."""
        self.core.close()
        super().failed(error)

    def _more_credit(self, data: bytes) -> None:
        """The recorder has dealt with everything up to a tick; nobody waits for it here."""
        (done,) = wire(CREDIT).unpack(data)
        self.credit = done + CREDIT_TICKS
