"""The driver as a node.

Parameters: any of the data sheet, ``manoeuvre.kind`` and the fields of that manoeuvre
(``manoeuvre.amplitude_deg``, ...).
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any

from rclpy.context import Context

from driver_model.driver import Driver
from driver_model.manoeuvres import make_manoeuvre
from steering_lockstep.core_parameters import check_own, parameter_set
from steering_lockstep.graph import NodeSpec
from steering_lockstep.node import LockstepNode
from steering_lockstep.ports import Ports, section
from steering_lockstep.settings import RunSettings


class DriverNode(LockstepNode):
    """Answers the measurements of each tick with the torque on the steering wheel."""

    ports = Ports(
        takes=(
            ("/steering/torque", "steering_wheel_angle"),
            ("/steering/torque", "steering_wheel_speed"),
            ("/steering/torque", "torsion_bar_torque"),
        )
    )


def driver_builder(ticks: int) -> Callable[[Mapping[str, Any]], Driver]:
    """Return the function that makes the driver of a node's parameter values."""

    def build(values: Mapping[str, Any]) -> Driver:
        check_own(values, ("duration",), ("manoeuvre",))
        return Driver(parameter_set(values), make_manoeuvre(**section(values, "manoeuvre")), ticks)

    return build


def make(
    context: Context, spec: NodeSpec, run: RunSettings, parameters: Mapping[str, Any] | None
) -> DriverNode:
    """Return the driver's node for a run."""
    return DriverNode(context, spec, run, parameters, driver_builder(run.ticks))
