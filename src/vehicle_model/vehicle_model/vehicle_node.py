"""The vehicle as a node: the rack's load on every tick, standard messages for viewers at 100 Hz.

Parameters: any of the data sheet, ``load.kind`` and the fields of that load,
``effects.EFFECT.PARAMETER``.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from typing import Any

from rclpy.context import Context

from steering_lockstep.core_parameters import check_own, effects_of, parameter_set
from steering_lockstep.graph import NodeSpec
from steering_lockstep.node import LockstepNode
from steering_lockstep.ports import Ports, section
from steering_lockstep.settings import RunSettings
from steering_lockstep.topics import topic
from vehicle_model.loads import make_load
from vehicle_model.model import slots, step
from vehicle_model.motion_messages import IMU, ODOMETRY, imu_fields, odometry_fields
from vehicle_model.vehicle import Vehicle


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

    def description(self, name: str) -> str:
        """Return what the node's parameter ``name`` is, its unit at the end."""
        if not name.startswith("effects."):
            return super().description(name)
        from steering_plant.effects import EFFECTS
        from steering_plant.effects.base import description

        return description(name, EFFECTS)


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

    return vehicle_model(effects, slots, step)


def make(
    context: Context, spec: NodeSpec, run: RunSettings, parameters: Mapping[str, Any] | None
) -> VehicleNode:
    """Return the vehicle's node for a run."""
    return VehicleNode(context, spec, run, parameters, vehicle_builder(run.ticks))
