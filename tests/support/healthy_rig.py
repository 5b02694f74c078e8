"""A rig without faults, as the frames that it sends: enough physics for its signals to agree."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from math import cos, pi, sin
from pathlib import Path
from random import Random
from typing import Any

import rig_bridge
from rig_bridge.rig_file import RigFile, load_rig
from rig_bridge.safety.faults import Fault
from rig_bridge.safety.frame_watch import Frame
from rig_bridge.safety.guard import Guard, Reply
from rig_bridge.safety.machine import State
from rig_bridge.safety.measurements import load_reference

PERIOD_NS = 1_000_000
EMULATED = Path(rig_bridge.__file__).parent / "rigs" / "emulated.yaml"
SWING_RAD_S = 3.0 * pi
NOISE = {
    "steering_wheel_angle": 8e-4,
    "steering_wheel_speed": 1e-2,
    "torsion_bar_torque": 4e-3,
    "left_pressure": 6e3,
    "right_pressure": 6e3,
    "supply_pressure": 6e3,
    "rack_position": 1.2e-5,
    "rack_speed": 2e-4,
    "rack_force": 4.0,
}


def emulated_rig(**watching: float) -> RigFile:
    """Return the emulated rig's file, its checks short, with other limits where given."""
    rig = load_rig(EMULATED)
    short = {"check_ticks": 20, "check_timeout_ticks": 100, "entry_ticks": 20}
    return rig.model_copy(update={"watching": rig.watching.model_copy(update=short | watching)})


class HealthyRig:
    """Sends frame k at k ms: the wheel swings by half a radian, the load and pressures follow."""

    def __init__(self, seed: int = 1) -> None:
        self.random = Random(seed)
        self.tick = 0
        self.moved = 0

    def values(self, sent: Mapping[str, float]) -> dict[str, float]:
        t = self.moved * 1e-3
        swing = 0.5 * sin(SWING_RAD_S * t)
        speed = 0.5 * SWING_RAD_S * cos(SWING_RAD_S * t) if self.moved else 0.0
        torque = 4.0 * swing
        values = dict.fromkeys(NOISE, 0.0)
        values["steering_wheel_angle"] = swing
        values["steering_wheel_speed"] = speed
        values["torsion_bar_torque"] = torque
        values["rack_position"] = (swing - torque / 60.734) / 130.9
        values["rack_speed"] = speed * (1.0 - 4.0 / 60.734) / 130.9
        values["left_pressure"] = sent["left_reference_pressure"]
        values["right_pressure"] = sent["right_reference_pressure"]
        values["supply_pressure"] = 2e7
        values["rack_force"] = load_reference(values | dict(sent))
        return {name: value + self.random.gauss(0.0, NOISE[name]) for name, value in values.items()}

    def frame(self, sent: Mapping[str, float], running: bool) -> Frame:
        self.tick += 1
        self.moved += running
        values = self.values(sent)
        return Frame(self.tick, self.tick * PERIOD_NS + 5_000_000_000, tuple(values.values()))


ASKED = {
    "driver_torque": 2.0,
    "left_reference_pressure": 1.5e6,
    "left_solenoid_force": 16.0,
    "right_reference_pressure": 5e5,
    "right_solenoid_force": 14.0,
    "load_force": 300.0,
    "load_stiffness": 5e4,
    "load_position": 0.0,
}


class Bench:
    """A guard with a healthy rig; ``tick`` does one period with or without an injected fault."""

    def __init__(self, rig: RigFile | None = None, seed: int = 1, bits: int = 32) -> None:
        self.guard = Guard(rig or emulated_rig(), bits)
        self.rig = HealthyRig(seed)
        self.now_ns = 0

    @property
    def state(self) -> State:
        """The guard's state."""
        return self.guard.state

    @property
    def fault(self) -> Fault:
        """Why the rig is safe."""
        assert self.guard.fault is not None
        return self.guard.fault

    def healthy(self) -> Frame:
        """Return the next frame; the wheel stands still during the checks."""
        moves = self.guard.state is not State.CHECKING
        return self.rig.frame(self.guard.commands.sent, moves)

    def tick(
        self,
        frames: Sequence[Frame] | None = None,
        asked: Mapping[str, float] | None = None,
        **options: Any,
    ) -> Reply:
        self.now_ns += PERIOD_NS
        given = [self.healthy()] if frames is None else frames
        return self.guard.step(given, self.now_ns, asked or ASKED, **options)

    def run(self, ticks: int) -> Reply:
        for _ in range(ticks):
            reply = self.tick()
        return reply

    def started(self, ticks: int = 147) -> Bench:
        """Pass the checks, come in, and run until the wheel is well away from the middle."""
        while self.guard.state is State.CHECKING:
            self.tick()
        self.run(ticks)
        assert self.guard.state is State.RUNNING, self.guard.fault
        return self

    def ticks_to_safe(
        self, frames: Callable[[], Sequence[Frame]], limit: int = 10, **options: Any
    ) -> int:
        """Return the ticks from the first of ``frames()`` until the rig is told to be safe."""
        for tick in range(1, limit + 1):
            reply = self.tick(frames(), **options)
            if reply.state is State.SAFE:
                assert reply.commands == self.guard.commands.safe
                return tick
        raise AssertionError(f"not safe after {limit} ticks")
