"""The bench's end of a check's topics (rclpy). Polled, so that the bench's time is its own."""

from __future__ import annotations

import os
from collections.abc import Iterable, Mapping, Sequence
from typing import Any

import rclpy
from rclpy.context import Context
from rclpy.node import Node
from rclpy.qos import QoSProfile, ReliabilityPolicy
from rclpy.signals import SignalHandlerOptions
from std_msgs.msg import String

from steering_bringup.check_node.program import loopback
from steering_lockstep.endpoints import message_class, qos
from steering_lockstep.standalone import READY, ready_qos
from steering_lockstep.topics import wire

BENCH = "check_bench"


class Link:
    """Publishers of the bench's topics, and a reader of the node's ``wishes``.

    best_effort: for a guest, whose publisher may have any reliability. Use as a context manager.
    """

    def __init__(
        self, topics: Iterable[str], wishes: str, domain: int, *, best_effort: bool
    ) -> None:
        os.environ.update(loopback())
        self._context = Context()
        no = SignalHandlerOptions.NO
        rclpy.init(context=self._context, domain_id=domain, signal_handler_options=no)
        self._node = Node(
            BENCH,
            context=self._context,
            use_global_arguments=False,
            enable_rosout=False,
            start_parameter_services=False,
        )
        self._publishers = {
            t: self._node.create_publisher(message_class(t), t, qos()) for t in topics
        }
        self._kind = message_class("/torque_overlay/any")
        quality: Any = QoSProfile(depth=100, reliability=ReliabilityPolicy.BEST_EFFORT)
        self._reader = self._node.create_subscription(
            self._kind, wishes, _nothing, quality if best_effort else qos()
        )
        self._ready = self._node.create_publisher(String, READY, ready_qos())

    def matched(self) -> bool:
        """Whether the node publishes what we read."""
        return bool(self._reader.handle.get_publisher_count())

    def read_by_node(self) -> list[str]:
        """Return the topics of the bench that the node has subscribed to, without the clock."""
        found = {t for t, p in self._publishers.items() if p.get_subscription_count()}
        return sorted(found - {"/clock"})

    def tell_ready(self) -> None:
        """Tell a node in lock step that the bench has all its connections."""
        self._ready.publish(String(data=BENCH))

    def publish(self, tick: int, fields: Mapping[str, Sequence[float]]) -> None:
        """Publish the messages of ``tick``."""
        for name, values in fields.items():
            self._publishers[name].publish(wire(name).pack(tick, values))

    def take(self) -> list[Any]:
        """Return the messages of the node that have come in."""
        found = []
        with self._reader.handle:
            while (taken := self._reader.handle.take_message(self._kind, False)) is not None:
                found.append(taken[0])
        return found

    def __enter__(self) -> Link:
        return self

    def __exit__(self, *exception: object) -> None:
        self._node.destroy_node()
        self._context.try_shutdown()


def _nothing(message: Any) -> None:
    """The reader is polled."""
