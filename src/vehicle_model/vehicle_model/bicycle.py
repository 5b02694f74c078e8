"""The linear bicycle model: one wheel for each axle, small angles, constant speed.

States: sideslip beta = v_y / v [1] and curvature kappa = r / v [1/m], with lateral velocity v_y and
yaw rate r of the centre of gravity; then heading psi [rad]. Input: rack displacement x [m], with
road wheel angle delta = x / arm. ISO 8855: positive goes with a left turn. Divided by the speed,
the states stay defined as the speed goes to zero, where the car just follows its wheels.

    F_yf = C_f (delta - beta - a kappa),   F_yr = C_r (-beta + b kappa)          lateral tyre forces
    m v (beta' + v kappa) = F_yf + F_yr,   I_z v kappa' = a F_yf - b F_yr,   psi' = v kappa
    F_rack = F_yf (n_p + n_m) / arm

with pneumatic trail n_p and mechanical trail n_m. See e.g. Mitschke and Wallentowitz, Dynamik der
Kraftfahrzeuge, or Gillespie, Fundamentals of Vehicle Dynamics, ch. 6.
"""

from __future__ import annotations

import math
from collections.abc import Mapping

import numpy as np

STATES = ("sideslip", "curvature", "heading")


def checked_speed(speed: float) -> float:
    """Return ``speed`` [m/s], or raise ValueError if it is negative or not finite."""
    if not (math.isfinite(speed) and speed >= 0.0):
        raise ValueError(f"the vehicle's speed must be finite and not negative, got {speed} m/s")
    return float(speed)


def continuous(p: Mapping[str, float], speed: float) -> tuple[np.ndarray, np.ndarray]:
    """Return A (3, 3) and B (3,) of z' = A z + B x for ``speed`` > 0 [m/s]."""
    front, rear = tyre_gains(p)
    lateral = (front + rear) / (p["mass"] * speed)
    arms = p["front_axle_distance"], p["rear_axle_distance"]
    yaw = (arms[0] * front - arms[1] * rear) / (p["yaw_inertia"] * speed)
    a_matrix = np.zeros((3, 3))
    a_matrix[0, :2] = lateral[:2] - np.array([0.0, speed])
    a_matrix[1, :2] = yaw[:2]
    a_matrix[2, 1] = speed
    return a_matrix, np.array([lateral[2], yaw[2], 0.0])


def tyre_gains(p: Mapping[str, float]) -> tuple[np.ndarray, np.ndarray]:
    """Return F_yf and F_yr [N] per sideslip, curvature and rack displacement, each shape (3,)."""
    a, b = p["front_axle_distance"], p["rear_axle_distance"]
    front = p["front_cornering_stiffness"] * np.array([-1.0, -a, 1.0 / p["steering_arm"]])
    rear = p["rear_cornering_stiffness"] * np.array([-1.0, b, 0.0])
    return front, rear


def rack_force_gains(p: Mapping[str, float]) -> np.ndarray:
    """Return the rack force [N] per sideslip, curvature and rack displacement, shape (3,).

    The last is the direct stiffness C_f (n_p + n_m) / arm^2 [N/m].
    """
    trail = p["pneumatic_trail"] + p["mechanical_trail"]
    return tyre_gains(p)[0] * trail / p["steering_arm"]


def kinematic_gains(p: Mapping[str, float]) -> np.ndarray:
    """Return sideslip and curvature per rack displacement as the speed goes to zero, shape (2,).

    Without centripetal force both slip angles vanish: kappa = delta / l, beta = b delta / l.
    """
    wheelbase = p["front_axle_distance"] + p["rear_axle_distance"]
    return np.array([p["rear_axle_distance"], 1.0]) / (wheelbase * p["steering_arm"])


def understeer_gradient(p: Mapping[str, float]) -> float:
    """Return K_us [rad s2/m] in delta = l kappa + K_us a_y; positive understeers."""
    a, b = p["front_axle_distance"], p["rear_axle_distance"]
    c_f, c_r = p["front_cornering_stiffness"], p["rear_cornering_stiffness"]
    return p["mass"] * (b * c_r - a * c_f) / ((a + b) * c_f * c_r)


def yaw_rate_gain(p: Mapping[str, float], speed: float) -> float:
    """Return the steady yaw rate per road wheel angle [1/s] at ``speed`` [m/s]."""
    wheelbase = p["front_axle_distance"] + p["rear_axle_distance"]
    return speed / (wheelbase + understeer_gradient(p) * speed**2)
