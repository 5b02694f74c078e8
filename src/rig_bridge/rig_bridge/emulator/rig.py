"""The emulated rig itself, without a clock: one ``step`` is one period of the rig."""

from __future__ import annotations

from collections import deque
from collections.abc import Sequence

from rig_bridge.emulator.sensors import Sensors
from rig_bridge.emulator.settings import EmulatorSettings
from rig_bridge.emulator.watchdog import RigWatchdog
from rig_bridge.rig_file import RigFile
from rig_bridge.transport.packets import Demand, Frame
from steering_core.parameters import load_parameters
from steering_plant.plant import Plant

PERIOD_NS = 1_000_000
INPUTS = (
    "driver_torque",
    "left_solenoid_force",
    "right_solenoid_force",
    "load_force",
    "load_stiffness",
    "load_position",
)


class EmulatedRig:
    """Steering gear with two pressure control valves, load cylinder and motor on the wheel.

    With ``command_delay`` 0 a command acts in the whole period whose measurements it answers, as in
    the simulated bench; with 1 in the period after it, as on a rig, where it comes too late for the
    one that has begun. In the safe state every actuator is without current, at once.
    sequence_bits: of the link's commands.
    """

    def __init__(self, rig: RigFile, settings: EmulatorSettings, sequence_bits: int) -> None:
        parameters = load_parameters(settings.parameter_set).with_values(settings.parameters)
        self.plant = Plant(parameters, "closed_centre")
        self.sensors = Sensors(settings.sensors, settings.seed)
        rows = rig.rows(rig.commanded)
        self.watchdog = RigWatchdog(rows, settings.stale_ticks, sequence_bits)
        self.names = rig.commanded
        self.safe = dict.fromkeys(INPUTS, 0.0)
        self.acting = deque([self.safe], maxlen=settings.command_delay + 1)
        self.start_ns = settings.clock_start_ns
        self.tick = 0

    def measure(self) -> Frame:
        """Return the measurements at the beginning of the period; once a period."""
        values = self.sensors.read(self.plant.out.tolist())
        rig_ns = self.start_ns + self.tick * PERIOD_NS
        return Frame(self.tick, rig_ns, values, self.watchdog.latched)

    def step(self, demands: Sequence[Demand]) -> None:
        """Do one period with the commands that answer it, or earlier ones if there is a delay."""
        obeyed = self.watchdog.tick(demands)
        values = self.safe if obeyed is None else self.safe | self._inputs(obeyed)
        self.acting.append(values)
        used = self.safe if obeyed is None else self.acting[0]
        self.plant.step(self.tick, *(used[name] for name in INPUTS))
        self.tick += 1

    def _inputs(self, values: Sequence[float]) -> dict[str, float]:
        pairs = zip(self.names, values, strict=True)
        return {name: value for name, value in pairs if name in INPUTS}
