"""What one node process is told to do. Pure, so that the supervisor never imports rclpy."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any

from steering_lockstep.settings import RunSettings


@dataclass(frozen=True)
class Job:
    """Run the nodes called ``names`` of ``run``'s graph in one process.

    ``parameters``: {node: {ROS parameter: value}}; ``environment`` is set before ROS starts;
    ``external``: nodes of the graph that somebody starts elsewhere; they are waited for.
    ``executor``: "module:function" of an executor to compare with, None: our own.
    """

    names: tuple[str, ...]
    run: RunSettings
    domain: int
    parameters: Mapping[str, Mapping[str, Any]] = field(default_factory=dict)
    environment: Mapping[str, str] = field(default_factory=dict)
    executor: str | None = None
    external: tuple[str, ...] = ()
