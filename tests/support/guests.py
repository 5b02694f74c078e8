"""Overlay nodes of plain rclpy, good and bad: python guests.py MANNER."""

from __future__ import annotations

import math
import sys
import time

import rclpy
from nav_msgs.msg import Odometry
from rclpy.node import Node
from steering_msgs.msg import TorqueOverlay

OLD = 0.05


class YawDamper(Node):
    """Asks against the yaw rate; ``manner`` says what it does wrong, "well" nothing."""

    def __init__(self, manner: str) -> None:
        super().__init__("yaw_damper")
        self.manner, self.yaw_rate, self.heard_at = manner, math.nan, 0.0
        self.publisher = self.create_publisher(TorqueOverlay, "/torque_overlay", 10)
        self.create_subscription(Odometry, "/vehicle/odometry", self.hear, 10)
        self.asked = 0
        self.create_timer(0.01, self.ask)

    def hear(self, message: Odometry) -> None:
        self.yaw_rate, self.heard_at = message.twist.twist.angular.z, time.monotonic()

    def ask(self) -> None:
        if self.manner == "crash" and self.heard_at:
            raise RuntimeError("there is no camera")
        careless = self.manner in ("careless", "in_bursts")
        fresh = time.monotonic() - self.heard_at < OLD and math.isfinite(self.yaw_rate)
        torque = 2.0 + self.yaw_rate if fresh or (careless and self.heard_at) else 0.0
        wish = TorqueOverlay(torque=torque, priority=1.0 if torque else -1.0, source="yaw_damper")
        self.asked += 1
        if self.manner == "in_bursts":
            wish.source = ""
            if self.asked % 50 > 5:
                return
        self.publisher.publish(wish)


def main() -> None:
    if sys.argv[1] == "absent":
        sys.exit("no such camera")
    rclpy.init()
    rclpy.spin(YawDamper(sys.argv[1]))


if __name__ == "__main__":
    main()
