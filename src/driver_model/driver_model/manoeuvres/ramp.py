"""To an angle at a constant speed."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from driver_model.manoeuvres.base import LARGEST_ANGLE_DEG, SHORTEST_TIME_S, Manoeuvre
from driver_model.manoeuvres.shapes import smooth_ramp

SLOWEST_DEG_S = 0.001


@dataclass(frozen=True)
class Ramp(Manoeuvre):
    """A ramp to ``angle_deg`` at ``speed_deg_s``, begun at ``start_s`` and held at its end.

    The wheel takes ``blend_s`` to get its speed and as long to lose it. A blend longer than the
    ramp itself leaves no part at full speed; the angle is reached all the same.
    """

    kind: ClassVar[str] = "ramp"

    angle_deg: float = 90.0
    speed_deg_s: float = 30.0
    start_s: float = 0.5
    blend_s: float = 0.2

    def __post_init__(self) -> None:
        self._check_angle("angle_deg")
        self._check("speed_deg_s", SLOWEST_DEG_S, 10.0 * LARGEST_ANGLE_DEG)
        self._check("start_s", 0.0)
        self._check("blend_s", SHORTEST_TIME_S)

    def angle(self, t: np.ndarray) -> np.ndarray:
        """Return the reference angle [rad] at times ``t`` [s]."""
        travel = abs(self.angle_deg) / self.speed_deg_s
        at_speed = smooth_ramp(t, self.start_s, self.blend_s)
        braking = smooth_ramp(t, self.start_s + travel, self.blend_s)
        speed = np.radians(np.copysign(self.speed_deg_s, self.angle_deg))
        return speed * (at_speed - braking)
