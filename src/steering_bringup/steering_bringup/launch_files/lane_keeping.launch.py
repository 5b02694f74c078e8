"""A car that keeps its lane: a source of torque overlays, and the arbiter.

Its arguments: ros2 launch steering_bringup lane_keeping.launch.py --show-args
"""

from launch import LaunchDescription

from steering_bringup.launching import bench


def generate_launch_description() -> LaunchDescription:
    """Return the launch description."""
    return bench({"scenario": "lane_keeping"})
