"""Quality of service and message classes of the bench's topics (rclpy)."""

from __future__ import annotations

import importlib
from typing import Any

from rclpy.qos import DurabilityPolicy, HistoryPolicy, QoSProfile, ReliabilityPolicy

from steering_lockstep.settings import CREDIT_EVERY, CREDIT_TICKS
from steering_lockstep.topics import topic

DEPTH = 2 * (CREDIT_TICKS + CREDIT_EVERY)


def qos() -> QoSProfile:
    """Return the quality of service of every lock-step topic.

    Reliable and volatile; deep enough for all that the recorder may lag behind, since a writer
    whose history is full asks its readers for an acknowledgement at every message.
    """
    return QoSProfile(
        history=HistoryPolicy.KEEP_LAST,
        depth=DEPTH,
        reliability=ReliabilityPolicy.RELIABLE,
        durability=DurabilityPolicy.VOLATILE,
    )


def message_class(name: str) -> Any:
    """Return the generated class of the messages on topic ``name``."""
    package, message = topic(name).type_name.split("/")
    return getattr(importlib.import_module(f"{package}.msg"), message)
