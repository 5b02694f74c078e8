"""The one table of topics: type, frame and how often each is published. Pure, no ROS import."""

from __future__ import annotations

import re
from collections.abc import Mapping
from dataclasses import dataclass, field
from difflib import get_close_matches
from functools import cache

from steering_lockstep.graph import CLOCK, CREDIT
from steering_lockstep.wire import Wire

__all__ = [
    "APPLIED",
    "CLOCK",
    "CREDIT",
    "DIAGNOSTICS",
    "LOAD_COMMAND",
    "OVERLAY",
    "TABLE",
    "Topic",
    "TopicError",
    "overlay_source",
    "topic",
    "wire",
]

DIAGNOSTICS = "/diagnostics"
OVERLAY = "/torque_overlay"
"""What guests outside the lock step publish on; a member has OVERLAY/NAME to itself."""
APPLIED = "/torque_overlay/applied"
LOAD_COMMAND = "/load_cylinder/command"
_SOURCE = re.compile(OVERLAY + r"/([a-z][a-z0-9_]{0,31})")


@dataclass(frozen=True)
class Topic:
    """A topic of the bench. ``every``: published on each such tick of its node, in node ticks.

    ``type_name`` as "package/Name"; ``strings``: its constant strings by path. ``lockstep`` is
    false for what comes on change only and is no member of the barrier. ``finite``: a number that
    is none ends the run; false where the reader deals with it.
    """

    name: str
    type_name: str
    strings: Mapping[str, str] = field(default_factory=dict)
    every: int = 1
    lockstep: bool = True
    finite: bool = True


def _ours(name: str, message: str, frame: str) -> Topic:
    return Topic(name, f"steering_msgs/{message}", {"header.frame_id": frame})


class _Topics(dict[str, Topic]):
    """The fixed topics, and one for each source of a torque overlay, made when it is looked up."""

    def __contains__(self, name: object) -> bool:
        return super().__contains__(name) or overlay_source(str(name)) is not None

    def __missing__(self, name: str) -> Topic:
        source = overlay_source(name)
        if source is None:
            raise KeyError(name)
        return _overlay(name, source)


def overlay_source(name: str) -> str | None:
    """Return NAME of the topic /torque_overlay/NAME; None for any other topic."""
    match = _SOURCE.fullmatch(name)
    return match.group(1) if match and name != APPLIED else None


def _overlay(name: str, source: str) -> Topic:
    strings = {"header.frame_id": "steering_wheel", "source": source}
    return Topic(name, "steering_msgs/TorqueOverlay", strings, finite=False)


TABLE: Mapping[str, Topic] = _Topics(
    (topic.name, topic)
    for topic in (
        _ours("/steering/torque", "SteeringTorque", "steering_wheel"),
        _ours("/steering/pressure", "ChamberPressure", "rack"),
        _ours("/steering/rack", "RackState", "rack"),
        _ours("/driver/torque", "DriverTorque", "steering_wheel"),
        _ours("/valve/left/command", "ValveCommand", "left_valve"),
        _ours("/valve/right/command", "ValveCommand", "right_valve"),
        _ours(LOAD_COMMAND, "LoadCommand", "load_cylinder"),
        _ours("/vehicle/rack_force", "RackForce", "rack"),
        _ours(APPLIED, "TorqueOverlayApplied", "steering_wheel"),
        _ours("/truth/plant", "PlantTruth", "plant"),
        _ours(CREDIT, "TickReport", "recorder"),
        Topic(CLOCK, "rosgraph_msgs/Clock"),
        Topic(
            "/vehicle/odometry",
            "nav_msgs/Odometry",
            {"header.frame_id": "odom", "child_frame_id": "base_link"},
            every=10,
        ),
        Topic("/vehicle/imu", "sensor_msgs/Imu", {"header.frame_id": "base_link"}, every=10),
        Topic(DIAGNOSTICS, "diagnostic_msgs/DiagnosticArray", lockstep=False),
    )
)


class TopicError(KeyError):
    """A topic is not in the table."""

    def __str__(self) -> str:
        return str(self.args[0])


def topic(name: str) -> Topic:
    """Return the topic called ``name``; raises ``TopicError`` naming the nearest one."""
    if name in TABLE:
        return TABLE[name]
    near = get_close_matches(name, TABLE, n=1, cutoff=0.0)
    raise TopicError(f"unknown topic {name}; nearest: {near[0]}")


@cache
def wire(name: str) -> Wire:
    """Return the byte layout of the messages on topic ``name``."""
    entry = topic(name)
    return Wire(entry.type_name, entry.strings)
