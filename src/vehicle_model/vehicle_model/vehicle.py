"""The vehicle: the rack's load, and the motion that follows from the rack's displacement."""

from __future__ import annotations

from types import ModuleType
from typing import NamedTuple

import numpy as np

from steering_core.parameters import ParameterSet, record
from steering_core.ticks import TICK_PERIOD, tick_times
from vehicle_model.loads import Load
from vehicle_model.model import step as nominal_model
from vehicle_model.motion import OUTPUTS, STATES, constants


class Odometry(NamedTuple):
    """Motion of the centre of gravity: position and heading on the ground, velocity in the car."""

    x: float  # m, forward at the start
    y: float  # m, to the left at the start
    heading: float  # rad, positive to the left
    v_x: float  # m/s, forward
    v_y: float  # m/s, to the left
    yaw_rate: float  # rad/s, positive to the left


class Imu(NamedTuple):
    """What an inertial sensor at the centre of gravity measures."""

    lateral_acceleration: float  # m/s2, positive to the left
    yaw_rate: float  # rad/s, positive to the left


class Vehicle:
    """The load ``load`` and the vehicle of a parameter set, sampled at 1 kHz.

    par: structured (1,), constants of the kernel. state: [sideslip, curvature 1/m, heading rad,
    x m, y m, rack_position m, side_wind N] at the last tick. out: [force N, stiffness N/m,
    position m], the rack's load F = force + stiffness (x - position), positive against positive
    displacement.
    external: given rack force [N] of ticks 0 to ``ticks``; afterwards its last value is kept.
    model: module with ``vehicle_step``; another one carries effects, whose parameters are
    ``effect_values`` and whose states at rest are ``effect_rest``.
    """

    def __init__(
        self,
        parameters: ParameterSet,
        load: Load,
        ticks: int,
        model: ModuleType = nominal_model,
        effect_values: np.ndarray | None = None,
        effect_rest: tuple[float, ...] = (),
    ) -> None:
        self.model = model
        self.effects = np.zeros(0) if effect_values is None else effect_values
        self.par = record(constants(parameters.group("vehicle"), load, TICK_PERIOD))
        self.external = np.ascontiguousarray(load.external(tick_times(ticks + 1)), np.float64)
        self.state = np.concatenate([np.zeros(len(STATES)), effect_rest])
        self.out = np.zeros(len(OUTPUTS))

    def step(self, tick: int, rack_x: float, rack_v: float, rack_force: float) -> np.ndarray:
        """Return ``out`` for the measurements of ``tick``, which must be called one after another.

        rack_x [m], rack_v [m/s], rack_force [N].
        """
        self.model.vehicle_step(
            self.par,
            self.external,
            self.effects,
            self.state,
            self.out,
            tick,
            rack_x,
            rack_v,
            rack_force,
        )
        return self.out

    def odometry(self) -> Odometry:
        """Return position and velocity at the last tick."""
        sideslip, curvature, heading, x, y, *_ = self.state[: len(STATES)].tolist()
        speed = float(self.par["speed"][0])
        return Odometry(x, y, heading, speed, speed * sideslip, speed * curvature)

    def imu(self) -> Imu:
        """Return lateral acceleration and yaw rate at the last tick."""
        p = self.par[0]
        sideslip, curvature, _, _, _, rack_position, wind = self.state[: len(STATES)].tolist()
        acceleration = (
            p["acceleration_by_sideslip"] * sideslip
            + p["acceleration_by_curvature"] * curvature
            + p["acceleration_by_position"] * rack_position
        )
        if wind != 0.0:
            acceleration += p["acceleration_by_wind"] * wind
        return Imu(float(acceleration), float(p["speed"]) * curvature)
