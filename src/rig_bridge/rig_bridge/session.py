"""One run with a rig: from the start-up checks before tick 0 to the report. Pure of ROS."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from typing import Any, Literal

from rig_bridge.bridge import Bridge
from rig_bridge.rig_file import RigFile
from rig_bridge.safety.machine import State
from rig_bridge.transport.link import Link
from steering_core.errors import BenchError
from steering_lockstep.outside import Status
from steering_lockstep.signals import PLACES

ANSWER_NS = 950_000
"""Commands are waited for so long after a measurement; the next one comes after 1 ms."""

FIRST_WAIT_S, NEXT_WAIT_S = 2e-3, 1e-3
"""A frame that is one period late is missing, and each period after it brings one more."""

FIRST_COMMANDS_TICKS = 100
"""For so long the commands of rest are held while the nodes' first ones are on their way."""

LISTED = 100
LAST_ORDERS = 3
Column = tuple[str, str]


def columns_of(rig: RigFile, columns: Sequence[Column]) -> dict[str, int]:
    """Return where each commanded channel is among ``columns``, the bench's (topic, field).

    BenchError names a channel that nothing of the bench feeds.
    """
    found = {}
    for name in rig.commanded:
        if PLACES[name] not in columns:
            topic, part = PLACES[name]
            raise BenchError(f"rig '{rig.name}' takes {name}, but nothing gives {part} of {topic}")
        found[name] = columns.index(PLACES[name])
    return found


@dataclass
class Session:
    """The rig as a clock (see ``steering_lockstep.outside``). Tick 0 comes once it is running.

    Before it the rig is checked, and the commands of rest come in, so that a run begins where a
    simulated one does. ``on_fault``: "end" ends the run in the safe state, "hold" goes on in it
    until a reset or the end.
    """

    rig: RigFile
    columns: Sequence[Column]
    connect: Callable[[], Link]
    on_fault: Literal["end", "hold"] = "end"
    failure: str | None = None
    changes: list[dict[str, Any]] = field(default_factory=list)
    lost_at: list[int] = field(default_factory=list)

    def __post_init__(self) -> None:
        self.index = columns_of(self.rig, self.columns)
        self.bridge: Bridge | None = None
        self.started = False
        self.closed = False
        self.wants_reset = False
        self.lost = 0
        self.begun = False
        self.commanded = False

    @property
    def preparing(self) -> bool:
        """Whether the rig is not ready for tick 0."""
        return not self.started

    @property
    def answer_by(self) -> int:
        """Until when commands are waited for, ns."""
        return self.open_bridge.arrived_ns + ANSWER_NS

    @property
    def open_bridge(self) -> Bridge:
        """The bridge, once it is open."""
        assert self.bridge is not None
        return self.bridge

    def open(self) -> None:
        """Open the link; raises BenchError."""
        link = self.connect()
        self.bridge = Bridge(self.rig, link)
        link.receive_frames(0.0)  # what had come before anybody listened
        self._note_state(None, 0)

    def receive(self, most: int) -> list[tuple[float, ...]]:
        """Wait for the rig's next period; return a row of measurements for each that began.

        most: how many are left of the run; what comes after them counts nowhere.
        """
        bridge = self.open_bridge
        waits = FIRST_WAIT_S if bridge.guard.measurements.fresh else NEXT_WAIT_S
        bridge.receive(waits, most)
        if not self.started:
            return []
        self.begun = self.begun or bool(bridge.periods)
        return bridge.periods

    def answer(
        self, tick: int, values: Sequence[float], age: int, late: str | None, ahead: int = 0
    ) -> None:
        """Send the commands among ``values``, or the safe ones; nothing once it is closed."""
        if self.closed:
            return
        bridge = self.open_bridge
        was = bridge.guard.state
        asked = {name: values[index] for name, index in self.index.items()}
        self.commanded = self.commanded or (self.begun and age == 0)
        excused = not self.commanded and tick < FIRST_COMMANDS_TICKS
        reset, self.wants_reset = self.wants_reset, False
        reply = bridge.answer(
            asked, asked_age=age, late=late, excused=excused, reset=reset, ahead=ahead
        )
        self._note_lost(tick)
        if reply.state is not was:
            self._note_state(was, tick)

    def reset(self) -> tuple[bool, str]:
        """Ask to leave the safe state; return whether there is one to leave, and a text."""
        if self.bridge is None or self.bridge.guard.state is not State.SAFE:
            return False, f"the rig is not in its safe state, but {self.state}"
        self.wants_reset = True
        return True, "the start-up checks begin again, then the commands come in"

    @property
    def state(self) -> str:
        """Name of the guard's state; "closed" before and after the run."""
        if self.bridge is None or self.closed:
            return "closed"
        return self.bridge.guard.state.value

    def status(self) -> Status:
        """Return the present state for /diagnostics."""
        fault = None if self.bridge is None else self.bridge.guard.fault
        if fault is not None:
            return Status("error", f"safe: {fault}")
        return Status("ok" if self.state == State.RUNNING.value else "warn", self.state)

    def numbers(self) -> dict[str, str]:
        """Return counts and latencies (s) as texts."""
        return {} if self.bridge is None else {k: str(v) for k, v in self.bridge.report().items()}

    def report(self) -> dict[str, Any]:
        """Return what a run's outcome and bag tell of the rig; times in s."""
        if self.bridge is None:
            return {"rig": self.rig.name, "state": "never connected", "changes": []}
        bridge = self.bridge
        state = bridge.guard.state.value
        report: dict[str, Any] = {"rig": self.rig.name, "state": state, **bridge.report()}
        report["since_measured"] = bridge.since_measured.report()
        report["clock_drift"] = bridge.offset.drift()
        return {**report, "changes": self.changes, "lost_at": self.lost_at}

    def close(self) -> None:
        """Leave the rig in its safe state and close the link. May be called twice."""
        if self.bridge is None or self.closed:
            return
        self.closed = True
        try:
            for _ in range(LAST_ORDERS):
                self.bridge.hold()
        finally:
            self.bridge.link.close()

    def _note_state(self, was: State | None, tick: int) -> None:
        guard = self.open_bridge.guard
        why = None if guard.fault is None else str(guard.fault)
        at = tick if self.started else None
        before = None if was is None else was.value
        self.changes.append({"tick": at, "from": before, "to": guard.state.value, "why": why})
        if guard.state is State.RUNNING and not self.started:
            self.started = True
            self.open_bridge.reset_report()
        if guard.state is State.SAFE and (self.on_fault == "end" or not self.started):
            self.failure = f"the rig is in its safe state: {why}"

    def _note_lost(self, tick: int) -> None:
        lost = self.open_bridge.guard.measurements.frames.lost
        if lost > self.lost and self.started and len(self.lost_at) < LISTED:
            self.lost_at.append(tick)
        self.lost = lost
