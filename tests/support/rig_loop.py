"""Bridge and emulated rig over a real link, but tick by tick in one thread: time is counted."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field

from healthy_rig import EMULATED, PERIOD_NS, emulated_rig

from rig_bridge.bridge import Bridge
from rig_bridge.emulator.rig import EmulatedRig
from rig_bridge.emulator.settings import EmulatorSettings, load_settings
from rig_bridge.rig_file import RigFile
from rig_bridge.safety.guard import Reply
from rig_bridge.safety.machine import State
from rig_bridge.transport.link import Link
from rig_bridge.transport.packets import Frame
from steering_core.parameters import load_parameters
from steering_plant.plant import plant_record
from steering_plant.rest import rest_solenoid_force

WAIT_S = 10.0
PAR = plant_record(load_parameters("nominal"), "closed_centre")[0]


SETTINGS = load_settings(EMULATED.with_name("emulator.yaml"))
Way = Callable[[Frame], list[Frame]]


def asked(left: float, right: float) -> dict[str, float]:
    """Commands that hold the chambers at a pressure [Pa] against a spring in the load."""
    return {
        "driver_torque": 0.0,
        "left_reference_pressure": left,
        "left_solenoid_force": rest_solenoid_force(PAR, left),
        "right_reference_pressure": right,
        "right_solenoid_force": rest_solenoid_force(PAR, right),
        "load_force": 0.0,
        "load_stiffness": 2e6,
        "load_position": 0.0,
    }


HOLD = asked(1.0e6, 2.0e6)


@dataclass
class Loop:
    """``tick``: the rig measures, the bench answers, the rig does a period.

    way: what becomes of a frame on its way, to inject faults. answers: whether commands get there.
    """

    bench_end: Link
    rig_end: Link
    table: RigFile = field(default_factory=emulated_rig)
    settings: EmulatorSettings = SETTINGS
    now_ns: int = 0
    wait_s: float = WAIT_S

    def __post_init__(self) -> None:
        self.bridge = Bridge(self.table, self.bench_end, lambda: self.now_ns)
        self.rig = EmulatedRig(self.table, self.settings, self.rig_end.sequence_bits)

    @property
    def state(self) -> State:
        """The guard's state."""
        return self.bridge.guard.state

    def tick(
        self,
        asked: Mapping[str, float],
        way: Way = lambda frame: [frame],
        answers: bool = True,
        reset: bool = False,
    ) -> Reply:
        sent = way(self.rig.measure())
        for frame in sent:
            self.rig_end.send_frame(frame)
        self.now_ns += PERIOD_NS
        self.bridge.receive(self.wait_s if sent else 0.0)
        reply = self.bridge.answer(asked, reset=reset)
        demands = self.rig_end.receive_demands(self.wait_s)
        self.rig.step(demands if answers else [])
        return reply

    def started(self, asked: Mapping[str, float], ticks: int = 150) -> Loop:
        """Pass the checks, come in, and run."""
        for _ in range(ticks):
            self.tick(asked)
        assert self.state is State.RUNNING, self.bridge.report()
        return self
