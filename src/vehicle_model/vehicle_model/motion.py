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

STATES = ("sideslip", "curvature", "heading", "x", "y", "rack_position")
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
    named = {
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
