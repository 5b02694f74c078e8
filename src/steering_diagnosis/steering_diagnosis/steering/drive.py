"""What drives the replay: prescribed states and held inputs, from a record's channels.

The sensors of inputs act inversely here: the wheel's true angle is what its sensor, with its gain,
offset, delay and lag, must have felt.
"""

from __future__ import annotations

from collections import OrderedDict
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Literal

import numpy as np
from scipy.interpolate import PchipInterpolator

from steering_core.errors import BenchError
from steering_core.parameters import ParameterSet
from steering_diagnosis.data.record import PERIOD_S, Record
from steering_diagnosis.steering.load import COMMAND as LOAD_COMMAND
from steering_diagnosis.steering.load import LoadCommand
from steering_diagnosis.steering.smoothing import (
    Curve,
    Spectrum,
    begins_moving,
    bridged,
    integrated,
    is_noise,
    low_pass,
    spectrum,
)
from steering_diagnosis.steering.standstill import calmed, restful, standstills
from steering_plant.model import states

KEPT = 4
"""Inputs of the replay that are remembered, by the sensors that they were measured with."""

RUN_UP = 200
"""Ticks before the record in which hidden states settle."""

VAPOUR = 0.95
"""Pressure of a chamber that is sucked empty, over a vacuum's; gauge pressures."""

BEYOND_HZ = 3.0
"""Lowest cut-off for what a load cell measures beyond the load's command."""

LONE_HZ = 250.0
"""Cut-off for a load cell without the load's command: what shakes the rack is in it alone."""

SLOW_HZ = 1.0
"""Lowest cut-off for what a sensor measures beyond the integrated speed."""

NEGLIGIBLE = {
    "steering_wheel_angle": 1e-7,
    "rack_force": 0.02,
    "rack_position": 1e-9,
    "left_pressure": 20.0,
    "right_pressure": 20.0,
    "supply_pressure": 20.0,
    "torsion_bar_torque": 1e-6,
}
"""Noise below which a channel is taken as it is, SI."""

SENSORS = {
    "steering_wheel_angle": "angle_sensor",
    "steering_wheel_speed": "angle_sensor",
    "torsion_bar_torque": "torque_sensor",
    "left_pressure": "left_pressure_sensor",
    "right_pressure": "right_pressure_sensor",
    "supply_pressure": "supply_pressure_sensor",
    "rack_position": "rack_position_sensor",
    "rack_speed": "rack_position_sensor",
    "rack_force": "rack_force_sensor",
}
"""The data sheet's group of each measured channel's sensor."""

MOVING = {"steering_wheel_angle": "steering_wheel_speed", "rack_position": "rack_speed"}
"""Positions and their speeds."""

COMMANDS = {
    "closed_centre": ("left_solenoid_force", "right_solenoid_force"),
    "servo_valve": ("left_solenoid_force", "right_solenoid_force"),
    "open_centre": (),
}


@dataclass(frozen=True)
class Sensor:
    """What a sensor does: measured = gain felt(t - delay) + offset, lag felt' = true - felt."""

    gain: float
    offset: float
    delay: float
    lag: float


def sensor(parameters: ParameterSet, channel: str) -> Sensor:
    """Return the sensor of a measured channel as the parameters have it."""
    group = SENSORS[channel]
    of_rate = channel in ("steering_wheel_speed", "rack_speed")
    return Sensor(
        parameters[f"{group}.gain"],
        0.0 if of_rate else parameters[f"{group}.offset"],
        parameters[f"{group}.delay"],
        parameters.values.get(f"{group}.lag", 0.0),
    )


@dataclass(frozen=True, repr=False, eq=False)
class Driven:
    """Arrays that the kernel takes, see ``kernels.simulate.simulate``; equal to itself alone."""

    at: np.ndarray
    given: np.ndarray
    slopes: np.ndarray
    held: np.ndarray
    rise: np.ndarray


class Drive:
    """The inputs of a record.

    load: where the rack's load is taken from: its load cell, the load's command, or nowhere; then
    the rack's motion is prescribed. valves: whether the valves' commands are known; otherwise the
    chambers' pressures are prescribed. cutoff_hz: one low-pass for all channels, None: each its
    own. BenchError where the record cannot drive a replay.
    """

    def __init__(self, record: Record, cutoff_hz: float | None = None) -> None:
        if "steering_wheel_angle" not in record:
            raise BenchError(
                f"'{record.name}' has no steering_wheel_angle, which drives the replay: map it"
            )
        self.record = record
        self._remembered: OrderedDict[object, Driven] = OrderedDict()
        self._moving = moving = begins_moving(record["steering_wheel_angle"])
        self._cutoff_hz = cutoff_hz
        self.curves = {
            name: Curve(
                record[name],
                negligible,
                RUN_UP,
                moving,
                self._low_pass_of(name),
                record.rate(name),
            )
            for name, negligible in NEGLIGIBLE.items()
            if name in record
        }
        self.load: Literal["cell", "command", "none"] = "none"
        if "rack_force" in record:
            self.load = "cell"
        elif all(name in record for name in LOAD_COMMAND):
            self.load = "command"
        elif "rack_position" not in record:
            raise BenchError(
                f"'{record.name}' has neither rack_force nor rack_position: one of them must be "
                "measured to replay it"
            )
        self.valves = all(name in record for name in COMMANDS[record.valve_system])
        if not self.valves and not {"left_pressure", "right_pressure"} <= set(record.channels):
            raise BenchError(
                f"'{record.name}' has neither the valves' commands nor both chamber pressures"
            )
        if cutoff_hz is None:
            for position, speed in MOVING.items():
                self._use_speed(position, speed)
            self._still = self._standstills()
            self._stand_still(*MOVING)
        self.command = self._load_command()
        if cutoff_hz is None:
            self._stand_still("rack_force")
        self._held = self._commands()

    def felt(self, channel: str, parameters: ParameterSet, order: int = 0) -> np.ndarray:
        """Return the true value of a measured channel, or a derivative, run-up included."""
        by = sensor(parameters, channel)
        offset = by.offset if order == 0 else 0.0
        return (self.curves[channel].taken(by.delay, by.lag, order) - offset) / by.gain

    def felt_raw(self, channel: str, parameters: ParameterSet) -> np.ndarray:
        """Return the true value of a measured channel, (n,), noise and all."""
        by = sensor(parameters, channel)
        values = bridged(self.record[channel])
        if by.delay > 0.0:
            ticks = np.arange(len(values))
            values = np.interp(ticks + by.delay / PERIOD_S, ticks, values)
        if by.lag > 0.0:
            values = values + by.lag * np.gradient(values, PERIOD_S)
        return (values - by.offset) / by.gain

    def as_smooth_as(self, channel: str, values: np.ndarray) -> np.ndarray:
        """Return ``values`` (n,) low-passed as the curve of ``channel`` is."""
        curve = self.curves[channel]
        return low_pass(values, curve.cutoff_hz) if curve.smoothed else values

    def inputs(self) -> dict[str, int]:
        """Return the channels that drive the replay, with the states that they prescribe."""
        channels = {"steering_wheel_angle": states.ANGLE}
        if self.load == "none":
            channels["rack_position"] = states.POSITION
        if not self.valves:
            channels |= {"left_pressure": states.LEFT, "right_pressure": states.RIGHT}
        return channels

    def driven(self, parameters: ParameterSet, inputs: Mapping[str, int] | None = None) -> Driven:
        """Return the kernel's arrays for sensors as ``parameters`` have them.

        inputs: channels with the states that they prescribe (of a position also its speed). The
        last ones are remembered: most parameters are none of a sensor's.
        """
        inputs = self.inputs() if inputs is None else inputs
        channels = [*inputs, *(["rack_force"] if self.load == "cell" else [])]
        by = tuple(sensor(parameters, channel) for channel in channels)
        key = (tuple(inputs.items()), by, parameters["oil.atmospheric_pressure"])
        if key not in self._remembered:
            self._remembered[key] = self._driven(parameters, inputs)
        self._remembered.move_to_end(key)
        while len(self._remembered) > KEPT:
            self._remembered.popitem(last=False)
        return self._remembered[key]

    def _driven(self, parameters: ParameterSet, inputs: Mapping[str, int]) -> Driven:
        at: list[int] = []
        given: list[np.ndarray] = []
        slopes: list[np.ndarray] = []
        for channel, state in inputs.items():
            orders = (0, 1) if state in (states.ANGLE, states.POSITION) else (0,)
            curves = [self.felt(channel, parameters, order) for order in range(len(orders) + 1)]
            if state in (states.LEFT, states.RIGHT):
                curves = _above_vacuum(curves, parameters["oil.atmospheric_pressure"])
            for order in orders:
                at.append(state + order)
                given.append(curves[order])
                slopes.append(curves[order + 1])
        held = self._held.copy()
        rise = np.zeros(len(held))
        if self.load == "cell":
            force = self.felt("rack_force", parameters)
            held[:, states.LOAD_FORCE] = force + self._jump
            rise[:-1] = force[1:] - held[:-1, states.LOAD_FORCE]
        return Driven(np.array(at), np.column_stack(given), np.column_stack(slopes), held, rise)

    @property
    def knows_load(self) -> bool:
        """Return whether the load's command is known beside what the load cell measures."""
        return {*LOAD_COMMAND, "rack_position"} <= set(self.record.channels)

    def _spectrum(self, channel: str) -> Spectrum:
        return spectrum(bridged(self.record[channel]), rate_hz=self.record.rate(channel))

    def _low_pass_of(self, channel: str) -> float | None:
        """Return the cut-off [Hz] of a channel's low-pass, None: where its signal ends."""
        if self._cutoff_hz is None and channel == "rack_force" and not self.knows_load:
            noisy = self._spectrum(channel).noise > NEGLIGIBLE[channel]
            return LONE_HZ if noisy else None
        return self._cutoff_hz

    def _use_speed(self, position: str, speed: str) -> None:
        """Take fast motion from the speed's channel, where that is the quieter one.

        It is so above the frequency at which the integrated speed's noise is as strong as the
        position's. Where the two disagree there by more than noise, the position stays.
        """
        if not {position, speed} <= set(self.record.channels):
            return
        own = self.curves[position]
        if not own.smoothed:
            return
        rate = bridged(self.record[speed])
        known = self._spectrum(speed)
        crossover = max(known.noise / (2.0 * np.pi * own.spectrum.noise), SLOW_HZ)
        if crossover > 0.5 * own.cutoff_hz:
            return
        moved = integrated(rate, known)
        beyond = bridged(self.record[position]) - moved
        slow = low_pass(beyond, crossover)
        fast = low_pass(beyond, own.cutoff_hz) - slow
        motion = low_pass(moved, own.cutoff_hz) - low_pass(moved, crossover)
        if is_noise(fast, motion, own.spectrum.noise):
            self.curves[position] = own.replaced(moved + slow)

    def _standstills(self) -> list[slice]:
        """Return where wheel and rack stand still, as far as their sensors know."""
        moving = [n for n in MOVING if n in self.curves]
        where = standstills(self.curves[n].values[RUN_UP:] for n in moving)
        for speed in MOVING.values():
            if speed in self.record:
                rate = bridged(self.record[speed])
                where = restful(where, rate, self._spectrum(speed).noise)
        return where

    def _stand_still(self, *channels: str) -> None:
        """Take noise out of channels where wheel and rack stand still."""
        for name in channels:
            curve = self.curves.get(name)
            if curve is not None and curve.smoothed:
                calm = calmed(curve.values[RUN_UP:], self._still, curve.spectrum.noise)
                self.curves[name] = curve.replaced(calm, curve.low_passed)

    def _load_command(self) -> LoadCommand | None:
        """Return the load's command where it is known, and how it jumps at the ticks."""
        self._jump = np.zeros(RUN_UP + len(self.record))
        if not self.knows_load:
            return None
        command = LoadCommand(self.record, self.curves["rack_position"].values[RUN_UP:])
        if self.load == "cell":
            curve = self.curves["rack_force"]
            self._jump[RUN_UP:] = low_pass(command.jump, curve.cutoff_hz)
            if curve.smoothed and self._cutoff_hz is None:
                self.curves["rack_force"] = self._quiet_force(command.measured())
        return command

    def _quiet_force(self, expected: np.ndarray) -> Curve:
        """Return the load cell's force with its noise taken out where the command explains it.

        Only what the cell measures beyond the command is smooth and small: it is low-passed, deep
        down where it holds nothing but noise.
        """
        beyond = bridged(self.record["rack_force"]) - expected
        known = spectrum(beyond, BEYOND_HZ, self.record.rate("rack_force"))
        beyond, slow = low_pass(beyond, known.cutoff_hz), low_pass(beyond, BEYOND_HZ)
        if np.std(beyond - slow) < known.noise:
            beyond = slow
        return self.curves["rack_force"].replaced(expected + beyond)

    def _commands(self) -> np.ndarray:
        """Return the held inputs that are commands, (run-up + n, 7)."""
        record = self.record
        held = np.zeros((RUN_UP + len(record), states.INPUTS))
        if self.valves:
            valves = (states.LEFT_SOLENOID, states.RIGHT_SOLENOID)
            for column, name in zip(valves, COMMANDS[record.valve_system], strict=False):
                held[:, column] = _led_in(bridged(record[name]))
        if self.load == "command":
            columns = (states.LOAD_FORCE, states.LOAD_STIFFNESS, states.LOAD_POSITION)
            for column, name in zip(columns, LOAD_COMMAND, strict=True):
                held[:, column] = _led_in(bridged(record[name]))
        return held


def _above_vacuum(curves: list[np.ndarray], atmosphere: float) -> list[np.ndarray]:
    """Return a pressure and its rate with no less than a chamber has that is sucked empty.

    The rate is a monotone cubic's: any other swings below a vacuum behind the kink.
    """
    least = -VAPOUR * atmosphere
    if curves[0].min() > least:
        return curves
    pressure = np.maximum(curves[0], least)
    time = np.arange(len(pressure)) * PERIOD_S
    return [pressure, PchipInterpolator(time, pressure).derivative()(time)]


def _led_in(values: np.ndarray) -> np.ndarray:
    """Return ``values`` with their first one held over the run-up."""
    return np.concatenate([np.full(RUN_UP, values[0]), values])
