"""The force control of the load cylinder as a node. Parameters: any of the data sheet."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from rclpy.context import Context

from pressure_control.load_force import LoadForceController
from steering_lockstep.core_parameters import check_own, parameter_set
from steering_lockstep.graph import NodeSpec
from steering_lockstep.node import LockstepNode
from steering_lockstep.ports import Ports
from steering_lockstep.settings import RunSettings


class LoadForceNode(LockstepNode):
    """Answers the load cell and the wanted rack force of each tick with the valve's opening."""

    ports = Ports(
        takes=(
            ("/steering/rack", "position"),
            ("/steering/rack", "speed"),
            ("/steering/rack", "force"),
            ("/vehicle/rack_force", "force"),
            ("/vehicle/rack_force", "stiffness"),
            ("/vehicle/rack_force", "position"),
        )
    )


def build_load_force(values: Mapping[str, Any]) -> LoadForceController:
    """Return the controller of a node's parameter values."""
    check_own(values, (), ())
    return LoadForceController(parameter_set(values))


def make(
    context: Context, spec: NodeSpec, run: RunSettings, parameters: Mapping[str, Any] | None
) -> LoadForceNode:
    """Return the force controller's node for a run."""
    return LoadForceNode(context, spec, run, parameters, build_load_force)
