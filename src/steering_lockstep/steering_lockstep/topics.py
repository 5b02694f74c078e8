"""The one table of topics: type, frame and how often each is published. Pure, no ROS import."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from difflib import get_close_matches
from functools import cache

from steering_lockstep.graph import CLOCK, CREDIT
from steering_lockstep.wire import Wire

__all__ = ["CLOCK", "CREDIT", "DIAGNOSTICS", "TABLE", "Topic", "TopicError", "topic", "wire"]

DIAGNOSTICS = "/diagnostics"


@dataclass(frozen=True)
class Topic:
    """A topic of the bench. ``every``: published on each such tick of its node, in node ticks.

    ``type_name`` as "package/Name"; ``strings``: its constant strings by path. ``lockstep`` is
    false for what comes on change only and is no member of the barrier.
    """

    name: str
    type_name: str
    strings: Mapping[str, str] = field(default_factory=dict)
    every: int = 1
    lockstep: bool = True


def _ours(name: str, message: str, frame: str) -> Topic:
    return Topic(name, f"steering_msgs/{message}", {"header.frame_id": frame})


TABLE: Mapping[str, Topic] = {
    topic.name: topic
    for topic in (
        _ours("/steering/torque", "SteeringTorque", "steering_wheel"),
        _ours("/steering/pressure", "ChamberPressure", "rack"),
        _ours("/steering/rack", "RackState", "rack"),
        _ours("/driver/torque", "DriverTorque", "steering_wheel"),
        _ours("/valve/left/command", "ValveCommand", "left_valve"),
        _ours("/valve/right/command", "ValveCommand", "right_valve"),
        _ours("/vehicle/rack_force", "RackForce", "rack"),
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
}


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
