"""A program of plain rclpy, as any user would write it: notes what comes on some topics.

    python topic_listener.py OUT COUNT SECONDS TOPIC=package/msg/Name ...

Ends when the first topic has brought COUNT messages, or after SECONDS; then writes JSON to OUT:
{topic: [[wall clock ns, hex of the bytes], ...]}. Prints "ready" once its subscriptions are there.
"""

from __future__ import annotations

import importlib
import json
import sys
import time
from pathlib import Path

import rclpy
from rclpy.node import Node


def main() -> None:
    out, count, seconds = Path(sys.argv[1]), int(sys.argv[2]), float(sys.argv[3])
    topics = dict(word.split("=") for word in sys.argv[4:])
    rclpy.init()
    node = Node("listener")
    heard: dict[str, list[tuple[int, str]]] = {topic: [] for topic in topics}

    def note(topic: str) -> None:
        package, _, name = topics[topic].split("/")
        kind = getattr(importlib.import_module(f"{package}.msg"), name)

        def take(data: bytes) -> None:
            heard[topic].append((time.monotonic_ns(), data.hex()))

        node.create_subscription(kind, topic, take, 5000, raw=True)

    for topic in topics:
        note(topic)
    print("ready", flush=True)
    deadline, first = time.monotonic() + seconds, next(iter(topics))
    while time.monotonic() < deadline and len(heard[first]) < count:
        rclpy.spin_once(node, timeout_sec=0.1)
    ending = time.monotonic() + 0.3  # what is on the way on other topics
    while time.monotonic() < ending:
        rclpy.spin_once(node, timeout_sec=0.05)
    out.write_text(json.dumps(heard))
    node.destroy_node()
    rclpy.shutdown()


if __name__ == "__main__":
    main()
