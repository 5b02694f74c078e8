"""The played topics as ROS publishers (rclpy)."""

from __future__ import annotations

import re
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

from steering_bringup.bags.sources import TopicInfo
from steering_bringup.errors import BenchError
from steering_bringup.playback.installed import NotPlayable, message_class
from steering_bringup.playback.player import DEPTH

CLOCK = "/clock"
ACKNOWLEDGE = 4
"""Subscribers are waited for after this part of what a publisher keeps."""

SECONDS = -(1 << 31), (1 << 31) - 1
"""What /clock can tell."""

PATIENCE = Duration(seconds=1.0)


class Publishers:
    """One node with a publisher for each topic. ``skipped``: {topic: why it is not published};
    ``counts``: {topic's name in the bag: published messages}.

    topics: those of the bag that are played, by label; names: what each is published as. clock:
    whether /clock is published beside them. Use as a context manager.
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
        self._name = {label: topics[label].name for label in self._publishers}
        self._send = {t: p.handle.publish_raw for t, p in self._publishers.items()}
        self._every = {t: max(1, _depth(topics[t]) // ACKNOWLEDGE) for t in self._publishers}
        self.counts = dict.fromkeys(self._name.values(), 0)
        self._clock: Any = None
        if clock and all(names[label] != CLOCK for label in self._publishers):
            self._clock = self._node.create_publisher(Clock, CLOCK, _qos(False, DEPTH))

    @property
    def topics(self) -> tuple[str, ...]:
        """The labels of the topics that are published."""
        return tuple(self._publishers)

    @property
    def has_clock(self) -> bool:
        """Whether ``tell_time`` publishes; not where the bag's own /clock is played."""
        return self._clock is not None

    def publish(self, topic: str, data: bytes) -> None:
        """Publish recorded bytes."""
        self._send[topic](data)
        self.counts[self._name[topic]] += 1

    def tell_time(self, nanoseconds: int) -> None:
        """Publish ``nanoseconds`` on /clock, as near as it can tell them."""
        message = Clock()
        seconds, message.clock.nanosec = divmod(nanoseconds, 10**9)
        message.clock.sec = min(max(seconds, SECONDS[0]), SECONDS[1])
        self._clock.publish(message)

    def hold_back(self, topic: str) -> None:
        """Wait now and then until subscribers have what they were sent; for playing flat out.

        A subscriber that does not answer in a second is not waited for again.
        """
        if self.counts[self._name[topic]] % self._every[topic] or topic in self._slow:
            return
        if not self._publishers[topic].wait_for_all_acked(PATIENCE):
            self._slow.add(topic)

    def wait_for(self, names: Iterable[str], seconds: float) -> None:
        """Wait until each of ``names`` has a subscriber; BenchError naming one that has none."""
        deadline = time.monotonic() + seconds
        missing = list(names)
        while missing := [n for n in missing if not self._subscribers(n)]:
            if time.monotonic() > deadline:
                raise BenchError(f"nobody has subscribed to {missing[0]} in {seconds:g} s")
            time.sleep(0.02)

    def _subscribers(self, name: str) -> int:
        try:
            return self._node.count_subscribers(name)
        except InvalidTopicNameException as error:
            raise BenchError(f"--wait-for {name}: no topic name: {_line(error)}") from None

    def close(self) -> None:
        """Wait until subscribers have the last messages, and leave."""
        for topic, publisher in self._publishers.items():
            if topic not in self._slow and publisher.get_subscription_count():
                publisher.wait_for_all_acked(PATIENCE)
        self._node.destroy_node()
        self._context.try_shutdown()

    def _make_all(self, topics: Mapping[str, TopicInfo], names: Mapping[str, str]) -> None:
        """Make a publisher for each topic that can be published, of each name's main type first."""
        made: dict[str, str] = {}
        for label in sorted(topics, key=lambda label: label != topics[label].name):
            info, name = topics[label], names[label]
            try:
                if info.name in made:
                    raise NotPlayable(f"{info.name} is played as {made[info.name]}")
                self._publishers[label] = self._make(message_class(info), name, info)
                made[info.name] = info.msgtype
            except NotPlayable as reason:
                self.skipped[label] = f"{reason} ({info.count} messages)"

    def _make(self, kind: Any, name: str, info: TopicInfo) -> Any:
        try:
            check_for_type_support(kind)
        except Exception as error:  # whatever loading a generated library raises
            raise NotPlayable(f"{info.msgtype} has no type support here: {error}") from None
        try:
            qos = _qos(info.durable, _depth(info))
            publisher = self._node.create_publisher(kind, name, qos)
        except InvalidTopicNameException as error:
            if name != info.name:
                raise BenchError(f"'{name}' is no topic name: {_line(error)}") from None
            hint = f"rename it, --remap '{name}:={_legal(name)}'"
            raise NotPlayable(f"no legal topic name: {hint}") from None
        except Exception as error:  # whatever the middleware refuses
            raise NotPlayable(f"it cannot be published as {name}: {_line(error)}") from None
        publisher.handle.__enter__()  # kept in use while it lives instead of once a message
        return publisher

    def __enter__(self) -> Publishers:
        return self

    def __exit__(self, *exception: object) -> None:
        self.close()


def _qos(durable: bool, depth: int) -> QoSProfile:
    """Reliable; volatile unless the recorded publisher kept messages."""
    kept = DurabilityPolicy.TRANSIENT_LOCAL if durable else DurabilityPolicy.VOLATILE
    return QoSProfile(
        history=HistoryPolicy.KEEP_LAST,
        depth=depth,
        reliability=ReliabilityPolicy.RELIABLE,
        durability=kept,
    )


def _depth(info: TopicInfo) -> int:
    """Return what the recorded publisher kept for late subscribers, where the bag tells it."""
    return info.depth if info.durable and info.depth else DEPTH


def _legal(name: str) -> str:
    """Return a legal topic name that is like ``name``."""
    parts = [re.sub(r"\W", "_", part, flags=re.ASCII) for part in name.split("/") if part]
    return "".join(f"/_{part}" if part[0].isdigit() else f"/{part}" for part in parts) or "/renamed"


def _line(error: Exception) -> str:
    return " ".join(str(error).split())
