"""The constants that one tick of the vehicle needs."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from vehicle_model.bicycle import (
    checked_speed,
    continuous,
    kinematic_gains,
    tyre_gains,
)
from vehicle_model.loads.base import Load
from vehicle_model.sampling import Sampled, first_order_hold

STATES = ("sideslip", "curvature", "heading", "x", "y", "rack_position", "side_wind")
OUTPUTS = ("force", "stiffness", "position")
SLOWEST = 1.0e-6


def sampled_bicycle(p: Mapping[str, float], speed: float, period: float) -> Sampled:
    """Return the bicycle sampled every ``period`` [s] at ``speed`` [m/s], zero included.

    At a standstill (below 1 um/s) it is the limit: wheels that roll where they point, at once.
    There the linear tyre gives no force, since its slip needs a rolling wheel: use the dry-park
    load.
    """
    if checked_speed(speed) >= SLOWEST:
        return first_order_hold(*continuous(p, speed), period)
    gains = np.append(kinematic_gains(p), 0.0)
    return Sampled(np.diag([0.0, 0.0, 1.0]), gains, gains)


def wind_response(p: Mapping[str, float], speed: float, period: float) -> np.ndarray:
    """Return what 1 N of side wind for one period adds to sideslip, curvature and heading, (3,).

    It acts wind_arm ahead of the centre of gravity: F on m v beta', F wind_arm on I_z v kappa'.
    """
    if speed < SLOWEST:
        return np.zeros(3)
    push = np.array([1.0 / p["mass"], p["wind_arm"] / p["yaw_inertia"], 0.0]) / speed
    return first_order_hold(continuous(p, speed)[0], push, period).held


def constants(p: Mapping[str, float], load: Load, period: float) -> dict[str, float]:
    """Return the kernel's constants for the data sheet's vehicle ``p`` under ``load``.

    ``stiffness`` is what a rack that moves within the coming tick feels at its end: the direct
    stiffness less what the tyre's slip gives way in one tick. At 70 km/h that is 0.3 % less;
    towards a standstill it goes to zero with the force itself, where the direct stiffness alone
    would act as a damper that is not there.
    """
    speed = checked_speed(p["speed"]) if load.moves else 0.0
    sampled = sampled_bicycle(p, speed, period)
    by_sideslip, by_curvature, by_position = load.force_gains(p)
    given_way = by_sideslip * sampled.slope[0] + by_curvature * sampled.slope[1]
    front, rear = tyre_gains(p)
    lateral = (front + rear) / p["mass"] if speed >= SLOWEST else np.zeros(3)
    wind = wind_response(p, speed, period)
    named = {
        "wind_force": p["wind_force"] if load.moves and speed >= SLOWEST else 0.0,
        "wind_start": p["wind_start"],
        "wind_rise": p["wind_rise"],
        "sideslip_by_wind": wind[0],
        "curvature_by_wind": wind[1],
        "heading_by_wind": wind[2],
        "acceleration_by_wind": 1.0 / p["mass"],
        "speed": speed,
        "period": period,
        "force_by_sideslip": by_sideslip,
        "force_by_curvature": by_curvature,
        "force_by_position": by_position,
        "stiffness": by_position + given_way,
        "acceleration_by_sideslip": lateral[0],
        "acceleration_by_curvature": lateral[1],
        "acceleration_by_position": lateral[2],
    }
    rows = zip(("sideslip", "curvature", "heading"), *sampled, strict=True)
    for name, transition, held, slope in rows:
        named[f"{name}_by_sideslip"], named[f"{name}_by_curvature"] = transition[:2]
        named[f"{name}_by_position"], named[f"{name}_by_rise"] = held, slope
    return {name: float(value) for name, value in named.items()}
