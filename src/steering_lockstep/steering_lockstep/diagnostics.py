"""What a node tells of itself on /diagnostics: on change, and once a second.

As REP 107 and diagnostic_updater have it: a status is called "node: task", names its hardware, is
OK, WARN or ERROR, and comes often enough (an aggregator takes one of 5 s for stale).
"""

from __future__ import annotations

from collections.abc import Mapping
from time import monotonic_ns
from typing import Any

from diagnostic_msgs.msg import DiagnosticArray, DiagnosticStatus, KeyValue
from rclpy.node import Node
from rclpy.qos import DurabilityPolicy, QoSProfile, ReliabilityPolicy

from steering_lockstep.topics import DIAGNOSTICS
from steering_lockstep.wire import NANOSECONDS_PER_TICK, TICKS_PER_SECOND

OK = DiagnosticStatus.OK
WARN = DiagnosticStatus.WARN
ERROR = DiagnosticStatus.ERROR
PERIOD = 1_000_000_000
"""ns of wall time after which a status is told again."""
HARDWARE = "steering bench"


class Diagnostics:
    """The state of ``node`` as others see it, under the name of ``task``.

    The last one is kept for who comes later. /diagnostics is one topic for all namespaces, so the
    namespace is in the name. ``due`` [ns of the monotonic clock]: when it is time to tell again.
    """

    def __init__(self, node: Node, task: str) -> None:
        self.hardware = HARDWARE + node.get_namespace().rstrip("/").replace("/", " ", 1)
        self.due = 0
        self._name = f"{node.get_fully_qualified_name().lstrip('/')}: {task}"
        self._last: tuple[Any, str] | None = None
        qos = QoSProfile(
            depth=1,
            reliability=ReliabilityPolicy.RELIABLE,
            durability=DurabilityPolicy.TRANSIENT_LOCAL,
        )
        self._publisher = node.create_publisher(DiagnosticArray, DIAGNOSTICS, qos)

    def changed(self, level: Any, text: str) -> bool:
        """Return whether ``level`` and ``text`` are others than were told last."""
        return (level, text) != self._last

    def tell(self, level: Any, text: str, tick: int, values: Mapping[str, Any]) -> None:
        """Publish ``level``, ``text`` and ``values``, stamped with ``tick``."""
        self._last = (level, text)
        self.due = monotonic_ns() + PERIOD
        message = DiagnosticArray()
        message.header.stamp.sec = tick // TICKS_PER_SECOND
        message.header.stamp.nanosec = tick % TICKS_PER_SECOND * NANOSECONDS_PER_TICK
        status = DiagnosticStatus(level=level, name=self._name, message=text)
        status.hardware_id = self.hardware
        status.values = [KeyValue(key=k, value=str(v)) for k, v in values.items()]
        message.status = [status]
        self._publisher.publish(message)
