"""The guard between bench and rig: each tick it decides what the rig is told."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from typing import NamedTuple

from rig_bridge.rig_file import RigFile
from rig_bridge.safety.commands import Commands
from rig_bridge.safety.faults import Fault, Kind
from rig_bridge.safety.frame_watch import Frame
from rig_bridge.safety.limits import smooth
from rig_bridge.safety.machine import Seen, State, next_state
from rig_bridge.safety.measurements import Measurements
from rig_bridge.safety.start_up import StartUp


class Reply(NamedTuple):
    """What a tick gives: commands for the rig and measurements for the bench, SI, by name."""

    state: State
    commands: Mapping[str, float]
    measured: Mapping[str, float]
    fresh: bool


class Guard:
    """Pure: time, frames and commands come in. ``fault`` is why the rig is safe.

    A tick is one ``step``, or ``measure`` and then ``command`` where the commands answer what was
    measured in the same tick.

    rig: the rig's file. sequence_bits: width of the link's sequence numbers.
    """

    def __init__(self, rig: RigFile, sequence_bits: int = 32) -> None:
        self.rig = rig
        self.measurements = Measurements(rig, sequence_bits)
        self.commands = Commands(rig)
        self.start_up = StartUp(rig.watching)
        self.state = State.CHECKING
        self.fault: Fault | None = None
        self.wrong: Fault | None = None
        self.entering = 0
        self.reset_was_held = False

    def step(
        self,
        frames: Iterable[Frame],
        now_ns: int,
        asked: Mapping[str, float],
        *,
        asked_age: int = 0,
        late: str | None = None,
        reset: bool = False,
        link_up: bool = True,
    ) -> Reply:
        """Do one tick; called once a period, also when no frame has come.

        frames, now_ns, link_up: see ``measure``. asked, asked_age, late, reset: see ``command``.
        """
        self.measure(frames, now_ns, link_up=link_up)
        return self.command(asked, asked_age=asked_age, late=late, reset=reset)

    def measure(
        self,
        frames: Iterable[Frame],
        now_ns: int,
        *,
        link_up: bool = True,
        problem: str | None = None,
        unheard: Callable[[], str | None] = lambda: None,
    ) -> Mapping[str, float]:
        """Begin a tick: take what has come; return the measurements that may be used, SI, by name.

        frames: those since the last tick. now_ns: this machine's clock. link_up: False when the
        transport knows that nobody is there; problem: why. unheard: whose frames do not come.
        """
        self.wrong = self.measurements.tick(frames, now_ns, self.commands.sent)
        if not link_up:
            self.wrong = Fault(Kind.LINK, None, problem or "the transport reports it")
        elif self.wrong is not None and self.wrong.kind is Kind.STALE and (names := unheard()):
            self.wrong = self.wrong._replace(text=f"{self.wrong.text}: {names}")
        return self.measurements.values

    def command(
        self,
        asked: Mapping[str, float],
        *,
        asked_age: int = 0,
        late: str | None = None,
        reset: bool = False,
    ) -> Reply:
        """End a tick: decide what the rig is told.

        asked: the bench's commands, SI, by name, and their age in ticks; late: who owes newer ones.
        reset: leaves the safe state when it becomes true.
        """
        wrong, was = self.wrong, self.state
        pressed = reset and not self.reset_was_held
        self.reset_was_held = reset
        is_fault = self._is_fault(wrong, asked, asked_age, late)
        seen = Seen(is_fault, *self._progress(wrong), pressed)
        self.state = next_state(was, seen)
        self._enter(was)
        self._send(asked)
        fresh = self.measurements.fresh
        return Reply(self.state, dict(self.commands.sent), self.measurements.values, fresh)

    def _is_fault(
        self, wrong: Fault | None, asked: Mapping[str, float], age: int, late: str | None
    ) -> bool:
        """Note the fault, if there is one in this state."""
        if self.state is State.SAFE:
            return False  # it is safe already, and the start-up checks follow a reset
        if self.state is State.CHECKING:
            wrong = self.start_up.fault()  # anything less only delays the checks
        elif wrong is None:
            wrong = self.commands.fault(asked, age, late)
        if wrong is not None:
            self.fault = wrong
        return wrong is not None

    def _progress(self, wrong: Fault | None) -> tuple[bool, bool]:
        """Return whether the checks have passed, and whether the commands are in."""
        if self.state is State.CHECKING:
            measurements = self.measurements
            return self.start_up.see(measurements.channels, measurements.fresh, wrong), False
        if self.state is State.ENTERING:
            self.entering += 1
        return False, self.entering >= self.rig.watching.entry_ticks

    def _enter(self, was: State) -> None:
        """Do what belongs to a change of state."""
        if self.state is State.CHECKING and was is State.SAFE:
            self.measurements.reset()
            self.start_up.reset()
            self.fault = None
        if self.state is State.ENTERING and was is not State.ENTERING:
            self.entering = 0

    def _send(self, asked: Mapping[str, float]) -> None:
        if self.state is State.RUNNING:
            self.commands.follow(asked, 1.0)
        elif self.state is State.ENTERING and self.entering > 0:
            self.commands.follow(asked, smooth(self.entering / self.rig.watching.entry_ticks))
        else:
            self.commands.make_safe()  # also in the first tick of entering: nobody checked them yet
