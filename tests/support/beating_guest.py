"""An overlay guest of plain rclpy: python beating_guest.py NAME HERTZ TORQUE PRIORITY COUNT."""

from __future__ import annotations

import sys
import time

import rclpy
from steering_msgs.msg import TorqueOverlay


def main() -> None:
    name, hertz, torque, priority, count = sys.argv[1], *map(float, sys.argv[2:])
    rclpy.init()
    node = rclpy.create_node(name)
    publisher = node.create_publisher(TorqueOverlay, "/torque_overlay", 10)
    while publisher.get_subscription_count() == 0:
        time.sleep(0.01)
    due = time.monotonic()
    for _ in range(int(count)):
        publisher.publish(TorqueOverlay(torque=torque, priority=priority, source=name))
        due += 1.0 / hertz
        time.sleep(max(0.0, due - time.monotonic()))
    rclpy.shutdown()


if __name__ == "__main__":
    main()
