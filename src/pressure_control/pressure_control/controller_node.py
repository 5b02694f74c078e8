"""A chamber's pressure controller as a node; a bench has one for each side.

Parameters: any of the data sheet, ``side`` (left or right), ``boost_curve.COLUMN`` (points of a
measured curve in place of the formula, as the plant takes them), ``controller`` (a name of
``pressure_control.controller.CONTROLLERS``).
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from rclpy.context import Context

from pressure_control.controller import CONTROLLERS
from steering_core.naming import unknown
from steering_lockstep.core_parameters import check_own, parameter_set
from steering_lockstep.graph import NodeSpec
from steering_lockstep.node import LockstepNode
from steering_lockstep.ports import Ports, section
from steering_lockstep.settings import RunSettings
from steering_lockstep.topics import APPLIED
from steering_plant.measured_boost_curve import boost_table

DEFAULT = "pressure_control_valve"


class ControllerNode(LockstepNode):
    """Answers the measurements of each tick with the valve's command."""

    ports = Ports(
        takes=(
            ("/steering/torque", "steering_wheel_angle"),
            ("/steering/torque", "steering_wheel_speed"),
            ("/steering/torque", "torsion_bar_torque"),
            ("/steering/pressure", "left"),
            ("/steering/pressure", "right"),
            ("/steering/pressure", "supply"),
            ("/steering/rack", "position"),
            ("/steering/rack", "speed"),
            ("/steering/rack", "force"),
        )
    )


class OverlaidControllerNode(ControllerNode):
    """The same, with the torque overlay that the arbiter applies."""

    ports = Ports(takes=(*ControllerNode.ports.takes, (APPLIED, "applied")))


def build_controller(values: Mapping[str, Any]) -> Any:
    """Return the controller of a node's parameter values."""
    check_own(values, ("side", "controller"), ("boost_curve",))
    kind = values.get("controller", DEFAULT)
    if kind not in CONTROLLERS:
        raise ValueError(unknown("controller", kind, CONTROLLERS))
    table = boost_table(section(values, "boost_curve"))
    return CONTROLLERS[kind](parameter_set(values), values.get("side", "left"), table)


def make(
    context: Context, spec: NodeSpec, run: RunSettings, parameters: Mapping[str, Any] | None
) -> ControllerNode:
    """Return a controller's node for a run."""
    kind = OverlaidControllerNode if APPLIED in spec.inputs else ControllerNode
    return kind(context, spec, run, parameters, build_controller)
