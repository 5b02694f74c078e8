"""Counts what is missing, by tick, of played topics; the answer is on standard output at SIGTERM.

    python _played_listener.py TICKS TOPIC ...

TICKS: length of the bag, which is played in a loop.
"""

from __future__ import annotations

import json
import signal
import sys
from collections.abc import Callable

import rclpy
from rclpy.experimental.events_executor import EventsExecutor
from rclpy.node import Node
from rclpy.signals import SignalHandlerOptions
from rclpy.task import Future

from steering_lockstep.endpoints import message_class
from steering_lockstep.topics import wire

DEPTH = 2000


class Count:
    """Messages of one topic that came, and those that should have come in between."""

    def __init__(self, topic: str, ticks: int) -> None:
        self.received = 0
        self.lost = 0
        self._next = -1
        self._ticks = ticks
        self._unpack: Callable[[bytes], tuple] = wire(topic).unpack

    def take(self, data: bytes) -> None:
        """Count one message."""
        tick = self._unpack(data)[0]
        if self._next >= 0:
            self.lost += (tick - self._next) % self._ticks
        self._next = (tick + 1) % self._ticks
        self.received += 1


def main() -> None:
    """Listen until SIGTERM."""
    counts = {topic: Count(topic, int(sys.argv[1])) for topic in sys.argv[2:]}
    ended: list[int] = []
    signal.signal(signal.SIGTERM, lambda number, frame: ended.append(number))
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    rclpy.init(signal_handler_options=SignalHandlerOptions.NO)
    node = Node("played_listener")
    for topic, count in counts.items():
        node.create_subscription(message_class(topic), topic, count.take, DEPTH, raw=True)
    executor = EventsExecutor()
    executor.add_node(node)
    print("ready", flush=True)
    while not ended:
        executor.spin_until_future_complete(Future(), timeout_sec=0.2)
    result = {t: {"received": c.received, "lost": c.lost} for t, c in counts.items()}
    print(json.dumps(result), flush=True)


if __name__ == "__main__":
    main()
