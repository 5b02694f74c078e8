"""The bench: any scenario with any node set, a process a node.

Its arguments: ros2 launch steering_bringup bench.launch.py --show-args
"""

from launch import LaunchDescription

from steering_bringup.launching import bench


def generate_launch_description() -> LaunchDescription:
    """Return the launch description."""
    return bench()
