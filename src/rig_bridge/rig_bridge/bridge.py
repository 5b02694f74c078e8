"""The bench's end of a link with the guard behind it: what takes the plant's place in real time."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from time import monotonic_ns

from rig_bridge.latency import Latency
from rig_bridge.rig_file import RigFile
from rig_bridge.safety.guard import Guard, Reply
from rig_bridge.safety.machine import State
from rig_bridge.transport.link import Link
from rig_bridge.transport.packets import Demand, Order

ORDERS = {
    State.CHECKING: Order.ARM,
    State.ENTERING: Order.RUN,
    State.RUNNING: Order.RUN,
    State.SAFE: Order.HOLD,
}


class Bridge:
    """Each tick ``receive``, then ``answer``. The rig is the clock: ``receive`` waits for it.

    clock: this machine's clock in ns; given by tests.
    """

    def __init__(self, rig: RigFile, link: Link, clock: Callable[[], int] = monotonic_ns) -> None:
        self.rig = rig
        self.link = link
        self.clock = clock
        self.guard = Guard(rig, link.sequence_bits)
        self.latency = Latency()
        self.sequence = 0
        self.arrived_ns = 0

    def receive(self, timeout_s: float) -> Mapping[str, float]:
        """Wait for the rig's next measurements; return those that may be used, SI, by name.

        Comes back without new ones after ``timeout_s``, so that a silent rig is noticed.
        """
        frames = self.link.receive_frames(timeout_s)
        self.arrived_ns = self.clock()
        return self.guard.measure(frames, self.arrived_ns, link_up=self.link.up)

    def answer(
        self, asked: Mapping[str, float], *, asked_age: int = 0, reset: bool = False
    ) -> Reply:
        """Send the commands of this tick, as far as the guard lets them through."""
        reply = self.guard.command(asked, asked_age=asked_age, reset=reset)
        values = tuple(reply.commands[name] for name in self.rig.commanded)
        answers = self.guard.measurements.frames.last or 0
        self.link.send_demand(Demand(self.sequence, answers, ORDERS[reply.state], values))
        self.sequence += 1
        if reply.fresh:
            self.latency.add(self.clock() - self.arrived_ns)
        return reply

    def report(self) -> dict[str, float | int | str | None]:
        """Return latency and counts so far, and why the rig is safe if it is."""
        frames = self.guard.measurements.frames
        counts = {"repeated_frames": frames.repeated, "late_frames": frames.late}
        counts["lost_frames"] = frames.lost
        reasons = {"fault": None if self.guard.fault is None else str(self.guard.fault)}
        link = {"bad_packets": self.link.bad, "link_problem": self.link.problem}
        limited = {"limited_commands": self.guard.commands.limited}
        return {**self.latency.report(), **counts, **link, **limited, **reasons}
