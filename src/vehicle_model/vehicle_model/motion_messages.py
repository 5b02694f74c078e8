"""The vehicle's motion as the numbers of standard messages, in wire order. Pure, no ROS import."""

from __future__ import annotations

from collections.abc import Mapping

from steering_lockstep.topics import wire
from vehicle_model.model.attitude import half_angle
from vehicle_model.vehicle import Imu, Odometry

ODOMETRY = "/vehicle/odometry"
IMU = "/vehicle/imu"
NOT_GIVEN = -1.0
"""First element of a covariance in sensor_msgs/Imu: there is no such estimate."""


def odometry_fields(motion: Odometry) -> list[float]:
    """Return the numbers of a nav_msgs/Odometry."""
    sine, cosine = half_angle(motion.heading)
    return _filled(
        ODOMETRY,
        {
            "pose.pose.position.x": motion.x,
            "pose.pose.position.y": motion.y,
            "pose.pose.orientation.z": sine,
            "pose.pose.orientation.w": cosine,
            "twist.twist.linear.x": motion.v_x,
            "twist.twist.linear.y": motion.v_y,
            "twist.twist.angular.z": motion.yaw_rate,
        },
    )


def imu_fields(motion: Imu) -> list[float]:
    """Return the numbers of a sensor_msgs/Imu."""
    return _filled(
        IMU,
        {
            "orientation.w": 1.0,
            "orientation_covariance[0]": NOT_GIVEN,
            "angular_velocity.z": motion.yaw_rate,
            "linear_acceleration.y": motion.lateral_acceleration,
        },
    )


def _filled(name: str, values: Mapping[str, float]) -> list[float]:
    return [values.get(path, 0.0) for path in wire(name).fields]
