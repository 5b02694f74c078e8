"""The driver's hands: their torque, and how much of the overlay they leave.

The torsion bar alone cannot tell: when an overlay moves the rack, the bar drags the steering wheel
along, and its torque then stands against the overlay without any hand on the wheel. What the hands
do follows from the wheel's balance, with inertia J and damping d,

    T_hand = J speed' + d speed + T_torsion bar    (+- the column's friction),

low-passed, which spares a derivative: J speed' becomes J (speed - its low-pass)/tau.
"""

from __future__ import annotations

import math
from typing import Any

from pressure_control.limits import bounded
from steering_core.compiled import kernel
from steering_core.ticks import TICK_PERIOD

LARGEST_TORQUE = 100.0
LARGEST_SPEED = 100.0
"""Of the steering wheel, [N m] and [rad/s]; more is not believed."""


@kernel
def hand_torque(p: Any, filters: Any, speed: float, torque: float) -> float:
    """Return the estimated torque [N m] of the hands, positive to the left.

    filters: states, shape (2,), the low-passed [torsion-bar torque + d speed, speed]. speed
    [rad/s], torque [N m]: measured. Not a number counts as zero.
    """
    speed = bounded(speed, -LARGEST_SPEED, LARGEST_SPEED) if math.isfinite(speed) else 0.0
    torque = bounded(torque, -LARGEST_TORQUE, LARGEST_TORQUE) if math.isfinite(torque) else 0.0
    felt = torque + p.steering_wheel_damping * speed
    filters[0] += p.hand_weight * (felt - filters[0])
    filters[1] += p.hand_weight * (speed - filters[1])
    return filters[0] + p.hand_inertia_rate * (speed - filters[1])


@kernel
def left_authority(p: Any, authority: float, wanted: float, hand: float) -> float:
    """Return the share of the overlay that the driver leaves, 0 to 1.

    authority: of the last tick. wanted [N m]: overlay before the limits; hand [N m]: the driver's
    torque. Against the overlay it takes authority at once, from override_start to override_full;
    it comes back within override_recovery.
    """
    against = -hand if wanted > 0.0 else hand
    if wanted == 0.0:
        against = 0.0
    left = (p.override_full - against) / (p.override_full - p.override_start)
    left = bounded(left, 0.0, 1.0)
    return min(left, authority + TICK_PERIOD / p.override_recovery)
