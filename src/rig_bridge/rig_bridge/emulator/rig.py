"""The emulated rig itself, without a clock: one ``step`` is one period of the rig."""

from __future__ import annotations

from collections import deque
from collections.abc import Mapping, Sequence

from pressure_control.load_force import LoadForceController
from rig_bridge.emulator.sensors import Sensors
from rig_bridge.emulator.settings import EmulatorSettings
from rig_bridge.emulator.watchdog import RigWatchdog
from rig_bridge.rig_file import RigFile
from rig_bridge.transport.packets import Demand, Frame
from steering_core.errors import BenchError
from steering_core.parameters import load_parameters
from steering_plant.plant import Plant

PERIOD_NS = 1_000_000
INPUTS = {
    "driver_torque": 0,
    "left_solenoid_force": 1,
    "left_valve_opening": 1,
    "right_solenoid_force": 2,
    "right_valve_opening": 2,
    "load_force": 3,
    "load_stiffness": 4,
    "load_position": 5,
    "load_valve_opening": 6,
}
"""Places of the commands among the plant's inputs; the references only go along."""

WHEEL, LOAD_VALVE = 0, 6
SETTLING = 500
"""Periods in the safe state before the first one, so that the chambers have emptied."""


class EmulatedRig:
    """Steering gear with its valves, load or load cylinder, and motor or hand on the wheel.

    With ``command_delay`` 0 a command acts in the whole period whose measurements it answers, as in
    the simulated bench; with 1 in the period after it, as on a rig, where it comes too late for the
    one that has begun. In the safe state every actuator takes its channel's safe value, at once,
    and a load cylinder is relieved by a force control of the rig's own.
    sequence_bits: of the link's commands. Raises BenchError for settings that cannot be.
    """

    def __init__(self, rig: RigFile, settings: EmulatorSettings, sequence_bits: int) -> None:
        try:
            parameters = load_parameters(settings.parameter_set).with_values(settings.parameters)
            self.plant = Plant(
                parameters,
                settings.valve_system,
                effects=settings.effects,
                load_cylinder=settings.load_cylinder,
            )
        except ValueError as error:
            raise BenchError(f"rig '{rig.name}' cannot be emulated: {error}") from None
        self.sensors = Sensors(settings.sensors, settings.seed)
        rows = rig.rows(rig.commanded)
        self.watchdog = RigWatchdog(rows, settings.stale_ticks, sequence_bits)
        self.names = rig.commanded
        self.hand = settings.hand
        self.relief = LoadForceController(parameters) if settings.load_cylinder else None
        self.safe = self._inputs({name: rig.channels[name].safe for name in rig.commanded})
        self.acting = deque([self.safe], maxlen=settings.command_delay + 1)
        self.start_ns = settings.clock_start_ns
        self.tick = -SETTLING
        self.running = 0
        while self.tick < 0:
            self._move(self.safe, safe=True)

    def measure(self) -> Frame:
        """Return the measurements at the beginning of the period; once a period."""
        values = self.sensors.read(self.plant.out.tolist())
        rig_ns = self.start_ns + self.tick * PERIOD_NS
        return Frame(self.tick, rig_ns, values, self.watchdog.latched)

    def step(self, demands: Sequence[Demand]) -> None:
        """Do one period with the commands that answer it, or earlier ones if there is a delay."""
        obeyed = self.watchdog.tick(demands)
        safe = obeyed is None
        self.acting.append(
            self.safe
            if obeyed is None
            else self._inputs(dict(zip(self.names, obeyed, strict=True)))
        )
        self.running = 0 if safe else self.running + 1
        self._move(self.safe if safe else self.acting[0], safe)

    def _move(self, inputs: Sequence[float], safe: bool) -> None:
        used = list(inputs)
        if self.hand is not None:
            angle, speed = self.plant.out[:2].tolist()
            used[WHEEL] = self.hand.torque(self.running * PERIOD_NS * 1e-9, angle, speed)
        if self.relief is not None and safe:
            used[LOAD_VALVE] = float(self._relieved())
        # The plant counts from its own beginning.
        self.plant.step(self.tick + SETTLING, *used)
        self.tick += 1

    def _relieved(self) -> float:
        assert self.relief is not None
        position, speed, force = self.plant.out[6:].tolist()
        return float(self.relief.step(0, position, speed, force, 0.0, 0.0, 0.0)[1])

    def _inputs(self, values: Mapping[str, float]) -> list[float]:
        inputs = [0.0] * (max(INPUTS.values()) + 1)
        for name, value in values.items():
            if name in INPUTS:
                inputs[INPUTS[name]] = value
        return inputs
