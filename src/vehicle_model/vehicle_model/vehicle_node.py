"""The vehicle as a node: the rack's load on every tick, standard messages for viewers at 100 Hz.

Parameters: any of the data sheet, ``load.kind`` and the fields of that load,
``effects.EFFECT.PARAMETER``.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from math import cos, sin
from typing import Any

from rclpy.context import Context

from steering_lockstep.core_parameters import check_own, effects_of, parameter_set
from steering_lockstep.graph import NodeSpec
from steering_lockstep.node import LockstepNode
from steering_lockstep.ports import Ports, section
from steering_lockstep.settings import RunSettings
from steering_lockstep.standalone import spin_alone
from steering_lockstep.topics import topic, wire
from vehicle_model.loads import make_load
from vehicle_model.model import slots, step
from vehicle_model.vehicle import Imu, Odometry, Vehicle

ODOMETRY = "/vehicle/odometry"
IMU = "/vehicle/imu"
NOT_GIVEN = -1.0
"""First element of a covariance in sensor_msgs/Imu: there is no such estimate."""


class VehicleNode(LockstepNode):
    """Answers the rack's state with the load on it."""

    ports = Ports(
        takes=(
            ("/steering/rack", "position"),
            ("/steering/rack", "speed"),
            ("/steering/rack", "force"),
        ),
        gives=("/vehicle/rack_force",),
    )

    def publish(self, tick: int, out: Sequence[float]) -> None:
        """Publish the load and, on every tenth of the node's ticks, the vehicle's motion."""
        super().publish(tick, out)
        node_tick = tick // self.spec.period
        if ODOMETRY in self.emit and node_tick % topic(ODOMETRY).every == 0:
            self.emit[ODOMETRY](tick, odometry_fields(self.core.odometry()))
        if IMU in self.emit and node_tick % topic(IMU).every == 0:
            self.emit[IMU](tick, imu_fields(self.core.imu()))


def odometry_fields(motion: Odometry) -> list[float]:
    """Return the numbers of a nav_msgs/Odometry in wire order."""
    return _filled(
        ODOMETRY,
        {
            "pose.pose.position.x": motion.x,
            "pose.pose.position.y": motion.y,
            "pose.pose.orientation.z": sin(0.5 * motion.heading),
            "pose.pose.orientation.w": cos(0.5 * motion.heading),
            "twist.twist.linear.x": motion.v_x,
            "twist.twist.linear.y": motion.v_y,
            "twist.twist.angular.z": motion.yaw_rate,
        },
    )


def imu_fields(motion: Imu) -> list[float]:
    """Return the numbers of a sensor_msgs/Imu in wire order."""
    return _filled(
        IMU,
        {
            "orientation.w": 1.0,
            "orientation_covariance[0]": NOT_GIVEN,
            "angular_velocity.z": motion.yaw_rate,
            "linear_acceleration.y": motion.lateral_acceleration,
        },
    )


def _filled(name: str, values: Mapping[str, float]) -> list[float]:
    return [values.get(path, 0.0) for path in wire(name).fields]


def vehicle_builder(ticks: int) -> Callable[[Mapping[str, Any]], Vehicle]:
    """Return the function that makes the vehicle of a node's parameter values."""

    def build(values: Mapping[str, Any]) -> Vehicle:
        check_own(values, ("duration",), ("load", "effects"))
        load = make_load(**section(values, "load"))
        return Vehicle(parameter_set(values), load, ticks, *with_effects(effects_of(values)))

    return build


def with_effects(effects: Mapping[str, Mapping[str, float]]) -> tuple[Any, ...]:
    """Return what a Vehicle takes for ``effects``; those of other models are passed over."""
    if not effects:
        return ()
    from steering_plant.effects.models import vehicle_model

    model, added = vehicle_model(effects, slots, step)
    return model, added.values, added.rests


def make(
    context: Context, spec: NodeSpec, run: RunSettings, parameters: Mapping[str, Any] | None
) -> VehicleNode:
    """Return the vehicle's node for a run."""
    return VehicleNode(context, spec, run, parameters, vehicle_builder(run.ticks))


def main() -> None:
    """Run the vehicle alone in a process."""
    spin_alone("vehicle", make)
