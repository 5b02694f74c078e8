"""The played topics as ROS publishers (rclpy)."""

from __future__ import annotations

import time
from collections.abc import Iterable, Mapping
from typing import Any

import rclpy
from rclpy.context import Context
from rclpy.duration import Duration
from rclpy.exceptions import InvalidTopicNameException
from rclpy.node import Node
from rclpy.qos import DurabilityPolicy, HistoryPolicy, QoSProfile, ReliabilityPolicy
from rclpy.signals import SignalHandlerOptions
from rclpy.type_support import check_for_type_support
from rosgraph_msgs.msg import Clock

from steering_bringup.errors import BenchError
from steering_bringup.playback.installed import NotPlayable, message_class
from steering_bringup.playback.source import TopicInfo

CLOCK = "/clock"
DEPTH = 1000
ACKNOWLEDGE_EVERY = DEPTH // 4
PATIENCE = Duration(seconds=1.0)


class Publishers:
    """One node with a publisher for each topic. ``skipped``: {topic: why it is not published}.

    topics: those of the bag that are played; names: what each is published as. clock: whether
    /clock is published beside them. Use as a context manager.
    """

    def __init__(
        self,
        topics: Mapping[str, TopicInfo],
        names: Mapping[str, str],
        *,
        clock: bool,
        domain: int | None = None,
    ) -> None:
        self.skipped: dict[str, str] = {}
        self.counts: dict[str, int] = {}
        self._slow: set[str] = set()
        self._context = Context()
        rclpy.init(
            context=self._context,
            domain_id=domain,
            signal_handler_options=SignalHandlerOptions.NO,
        )
        self._node = Node(
            "bag_player",
            context=self._context,
            use_global_arguments=False,
            enable_rosout=False,
            start_parameter_services=False,
        )
        self._publishers: dict[str, Any] = {}
        try:
            self._make_all(topics, names)
        except BenchError:
            self.close()
            raise
        self._send = {t: p.handle.publish_raw for t, p in self._publishers.items()}
        self.counts = dict.fromkeys(self._publishers, 0)
        own = names.get(CLOCK) if CLOCK in self._publishers else None
        self._clock: Any = None
        if clock and own != CLOCK:
            self._clock = self._node.create_publisher(Clock, CLOCK, _qos(False))

    @property
    def topics(self) -> tuple[str, ...]:
        """The topics of the bag that are published."""
        return tuple(self._publishers)

    @property
    def has_clock(self) -> bool:
        """Whether ``tell_time`` publishes; not where the bag's own /clock is played."""
        return self._clock is not None

    def publish(self, topic: str, data: bytes) -> None:
        """Publish recorded bytes."""
        self._send[topic](data)
        self.counts[topic] += 1

    def tell_time(self, nanoseconds: int) -> None:
        """Publish ``nanoseconds`` on /clock."""
        message = Clock()
        message.clock.sec, message.clock.nanosec = divmod(nanoseconds, 10**9)
        self._clock.publish(message)

    def hold_back(self, topic: str) -> None:
        """Wait now and then until subscribers have what they were sent; for playing flat out.

        A subscriber that does not answer in a second is not waited for again.
        """
        if self.counts[topic] % ACKNOWLEDGE_EVERY or topic in self._slow:
            return
        if not self._publishers[topic].wait_for_all_acked(PATIENCE):
            self._slow.add(topic)

    def wait_for(self, names: Iterable[str], seconds: float) -> None:
        """Wait until each of ``names`` has a subscriber; BenchError naming one that has none."""
        deadline = time.monotonic() + seconds
        missing = list(names)
        while missing := [n for n in missing if not self._node.count_subscribers(n)]:
            if time.monotonic() > deadline:
                raise BenchError(f"nobody has subscribed to {missing[0]} in {seconds:g} s")
            time.sleep(0.02)

    def close(self) -> None:
        """Wait until subscribers have the last messages, and leave."""
        for topic, publisher in self._publishers.items():
            if topic not in self._slow and publisher.get_subscription_count():
                publisher.wait_for_all_acked(PATIENCE)
        self._node.destroy_node()
        self._context.try_shutdown()

    def _make_all(self, topics: Mapping[str, TopicInfo], names: Mapping[str, str]) -> None:
        for topic, info in topics.items():
            try:
                self._publishers[topic] = self._make(message_class(info), names[topic], info)
            except NotPlayable as reason:
                self.skipped[topic] = str(reason)

    def _make(self, kind: Any, name: str, info: TopicInfo) -> Any:
        try:
            check_for_type_support(kind)
        except Exception as error:  # whatever loading a generated library raises
            raise NotPlayable(f"{info.msgtype} has no type support here: {error}") from None
        try:
            publisher = self._node.create_publisher(kind, name, _qos(info.durable))
        except InvalidTopicNameException as error:
            raise BenchError(f"'{name}' is no topic name: {' '.join(str(error).split())}") from None
        publisher.handle.__enter__()  # kept in use while it lives instead of once a message
        return publisher

    def __enter__(self) -> Publishers:
        return self

    def __exit__(self, *exception: object) -> None:
        self.close()


def _qos(durable: bool) -> QoSProfile:
    """Reliable; volatile unless the recorded publisher kept its last message."""
    kept = DurabilityPolicy.TRANSIENT_LOCAL if durable else DurabilityPolicy.VOLATILE
    return QoSProfile(
        history=HistoryPolicy.KEEP_LAST,
        depth=DEPTH,
        reliability=ReliabilityPolicy.RELIABLE,
        durability=kept,
    )
