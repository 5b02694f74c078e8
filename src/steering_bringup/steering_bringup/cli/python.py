"""``steer python``: a Python program of one's own where rclpy and the bench's messages are."""

from __future__ import annotations

import argparse
import os
import sys

from steering_bringup.cli.ros_options import add_domain, settle_domain
from steering_lockstep.middleware import ros_environment

EXAMPLES = """examples:
  ROS_DOMAIN_ID=42 steer python pull_left.py
  ROS_DOMAIN_ID=42 ROS_AUTOMATIC_DISCOVERY_RANGE=SUBNET steer python pull_left.py --torque 2"""


def arguments(parser: argparse.ArgumentParser) -> None:
    """Declare the options."""
    add_domain(parser, "0")
    parser.add_argument("program", metavar="FILE", help="the program")
    parser.add_argument("words", metavar="...", nargs=argparse.REMAINDER, help="its arguments")


def execute(options: argparse.Namespace) -> int:
    """Become the program: its status and its signals are those of this process."""
    settle_domain(options)
    os.environ.update(ros_environment(os.environ))
    os.execv(sys.executable, [sys.executable, options.program, *options.words])
