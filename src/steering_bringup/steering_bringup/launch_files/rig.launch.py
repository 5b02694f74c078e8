"""A rig in the plant's place; the emulated one by default, started here too.

Its arguments: ros2 launch steering_bringup rig.launch.py --show-args
"""

from launch import LaunchDescription

from steering_bringup.launching import bench


def generate_launch_description() -> LaunchDescription:
    """Return the launch description."""
    return bench({"scenario": "on_centre", "node_set": "closed_centre"}, rig=True)
