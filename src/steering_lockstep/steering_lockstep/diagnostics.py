"""What the clock tells on /diagnostics, on change only."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from diagnostic_msgs.msg import DiagnosticArray, DiagnosticStatus, KeyValue
from rclpy.node import Node
from rclpy.qos import DurabilityPolicy, QoSProfile, ReliabilityPolicy

from steering_lockstep.topics import DIAGNOSTICS
from steering_lockstep.wire import NANOSECONDS_PER_TICK, TICKS_PER_SECOND

OK = DiagnosticStatus.OK
WARN = DiagnosticStatus.WARN
ERROR = DiagnosticStatus.ERROR


class Diagnostics:
    """The state of node ``name`` as others see it. The last one is kept for who comes later."""

    def __init__(self, node: Node, name: str) -> None:
        self._name = name
        self._last: tuple[Any, str] | None = None
        qos = QoSProfile(
            depth=1,
            reliability=ReliabilityPolicy.RELIABLE,
            durability=DurabilityPolicy.TRANSIENT_LOCAL,
        )
        self._publisher = node.create_publisher(DiagnosticArray, DIAGNOSTICS, qos)

    def tell(
        self, level: Any, text: str, tick: int, values: Mapping[str, str] | None = None
    ) -> None:
        """Publish ``level`` and ``text``, stamped with ``tick``, if they are not the last ones.

        ``values``: numbers beside them, published in any case.
        """
        if (level, text) == self._last and not values:
            return
        self._last = (level, text)
        message = DiagnosticArray()
        message.header.stamp.sec = tick // TICKS_PER_SECOND
        message.header.stamp.nanosec = tick % TICKS_PER_SECOND * NANOSECONDS_PER_TICK
        status = DiagnosticStatus(level=level, name=self._name, message=text, hardware_id="bench")
        status.values = [KeyValue(key=k, value=v) for k, v in (values or {}).items()]
        message.status = [status]
        self._publisher.publish(message)
