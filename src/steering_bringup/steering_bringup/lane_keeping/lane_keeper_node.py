"""The lane keeper as a node in lock step. Parameters: any of the data sheet."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from rclpy.context import Context

from steering_bringup.lane_keeping.keeper import LaneKeeper
from steering_lockstep.core_parameters import check_own, parameter_set
from steering_lockstep.graph import NodeSpec
from steering_lockstep.node import LockstepNode
from steering_lockstep.ports import Ports
from steering_lockstep.settings import RunSettings

ODOMETRY = "/vehicle/odometry"


class LaneKeeperNode(LockstepNode):
    """Answers the vehicle's motion with a torque overlay."""

    ports = Ports(
        takes=(
            (ODOMETRY, "pose.pose.position.x"),
            (ODOMETRY, "pose.pose.position.y"),
            (ODOMETRY, "pose.pose.orientation.z"),
            (ODOMETRY, "pose.pose.orientation.w"),
            (ODOMETRY, "twist.twist.linear.x"),
            (ODOMETRY, "twist.twist.linear.y"),
            (ODOMETRY, "twist.twist.angular.z"),
        )
    )


def make(
    context: Context, spec: NodeSpec, run: RunSettings, parameters: Mapping[str, Any] | None
) -> LaneKeeperNode:
    """Return the lane keeper's node for a run."""

    def build(values: Mapping[str, Any]) -> LaneKeeper:
        check_own(values, (), ())
        return LaneKeeper(parameter_set(values), spec.period)

    return LaneKeeperNode(context, spec, run, parameters, build)
