"""The bench's end of a link with the guard behind it: what takes the plant's place in real time."""

from __future__ import annotations

import sys
from collections.abc import Callable, Mapping
from time import monotonic_ns

from rig_bridge.clock_offset import ClockOffset
from rig_bridge.latency import Latency
from rig_bridge.rig_file import RigFile
from rig_bridge.safety.guard import Guard, Reply
from rig_bridge.safety.machine import State
from rig_bridge.transport.link import Link
from rig_bridge.transport.packets import Demand, Order

MOST_TICKS = sys.maxsize
ORDERS = {
    State.CHECKING: Order.ARM,
    State.ENTERING: Order.RUN,
    State.RUNNING: Order.RUN,
    State.SAFE: Order.HOLD,
}


class Bridge:
    """Each tick ``receive``, then ``answer``. The rig is the clock: ``receive`` waits for it.

    ``latency``: from a measurement's arrival to its command on the wire; ``since_measured``: from
    the measurement itself by the rig's clock, less the shortest way. A measurement that is
    answered with an old command (``held``) counts until a newer one is on the wire. ``periods``:
    measured values, SI, of each period of the rig that began since the last ``receive``.
    clock: this machine's clock in ns; given by tests.
    """

    def __init__(self, rig: RigFile, link: Link, clock: Callable[[], int] = monotonic_ns) -> None:
        self.rig = rig
        self.link = link
        self.clock = clock
        self.guard = Guard(rig, link.sequence_bits)
        self.latency = Latency()
        self.since_measured = Latency()
        self.offset = ClockOffset()
        self.periods: list[tuple[float, ...]] = []
        self.open_ticks: list[tuple[int, int]] = []
        self.held = 0
        self.sequence = 0
        self.arrived_ns = 0

    def receive(self, timeout_s: float, most: int = MOST_TICKS) -> Mapping[str, float]:
        """Wait for the rig's next measurements; return those that may be used, SI, by name.

        Comes back without new ones after ``timeout_s``, so that a silent rig is noticed.
        most: how many of the ``periods`` count; what comes after them is nobody's.
        """
        frames = self.link.receive_frames(timeout_s)
        self.arrived_ns = self.clock()
        link = self.link
        measured = self.guard.measure(
            frames, self.arrived_ns, link_up=link.up, problem=link.problem, unheard=link.unheard
        )
        self.periods = self.guard.measurements.periods[:most]
        if self.guard.measurements.fresh:
            rig_ns = self.guard.measurements.clock.rig_ns
            waited = 0 if rig_ns is None else self.offset.see(rig_ns, self.arrived_ns)
            self.open_ticks += [(self.arrived_ns, waited)] * len(self.periods)
        return measured

    def answer(
        self,
        asked: Mapping[str, float],
        *,
        asked_age: int = 0,
        late: str | None = None,
        excused: bool = False,
        reset: bool = False,
        ahead: int = 0,
    ) -> Reply:
        """Send the commands of this tick, as far as the guard lets them through.

        excused: old commands are no fault. ahead: how many of the measurements that came last are
        not answered by these commands, but by later ones.
        """
        was = self.guard.state
        age = 0 if excused else asked_age
        reply = self.guard.command(asked, asked_age=age, late=late, reset=reset)
        if was is State.SAFE and reply.state is State.CHECKING:
            self.offset.reset()
            self.link.meet()  # the rig obeys nothing more in a session that was told to hold
        self._send(ORDERS[reply.state], reply.commands)
        if asked_age > 0:
            self.held += reply.fresh
        else:
            self._close_ticks(ahead)
        return reply

    def hold(self) -> None:
        """Tell the rig to be safe, whatever the state; at the end of a run."""
        self._close_ticks()
        self.guard.commands.make_safe()
        self._send(Order.HOLD, self.guard.commands.sent)

    def reset_report(self) -> None:
        """Begin to count latencies again."""
        self.latency.reset()
        self.since_measured.reset()
        self.held = 0

    def report(self) -> dict[str, float | int | str | None]:
        """Return latency and counts so far, and why the rig is safe if it is."""
        frames = self.guard.measurements.frames
        counts = {"repeated_frames": frames.repeated, "late_frames": frames.late}
        counts["lost_frames"] = frames.lost
        counts["bridged_samples"] = sum(w.bridged for w in self.guard.measurements.channels)
        reasons = {"fault": None if self.guard.fault is None else str(self.guard.fault)}
        link = {"bad_packets": self.link.bad, "link_problem": self.link.problem}
        if self.link.peer is not None:
            link |= {f"{why}_packets": count for why, count in self.link.peer.counts.items()}
        limited = {"limited_commands": self.guard.commands.limited, "held": self.held}
        return {**self.latency.report(), **counts, **link, **limited, **reasons}

    def _send(self, order: Order, commands: Mapping[str, float]) -> None:
        values = tuple(commands[name] for name in self.rig.commanded)
        answers = self.guard.measurements.frames.last or 0
        self.link.send_demand(Demand(self.sequence, answers, order, values))
        self.sequence += 1

    def _close_ticks(self, ahead: int = 0) -> None:
        now, answered = self.clock(), max(len(self.open_ticks) - ahead, 0)
        for arrived, waited in self.open_ticks[:answered]:
            self.latency.add(now - arrived)
            self.since_measured.add(now - arrived + waited)
        del self.open_ticks[:answered]
