"""Take the wheel, change the lane, and let go again."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from driver_model.manoeuvres.base import SHORTEST_TIME_S, Manoeuvre
from driver_model.manoeuvres.shapes import smooth_step

BLEND = 0.1
"""Share of the steering's time in which it fades in, and out at its end."""


@dataclass(frozen=True)
class LaneChange(Manoeuvre):
    """Hands off until ``start_s``; then one sine of steering within ``change_s``, first to the
    left for a positive ``angle_deg``; then straight for ``hold_s``; then hands off again.

    One sine moves the car aside and leaves its course as it was.
    """

    kind: ClassVar[str] = "lane_change"

    angle_deg: float = 12.0
    start_s: float = 4.0
    change_s: float = 4.0
    hold_s: float = 2.0

    def __post_init__(self) -> None:
        self._check_angle("angle_deg")
        self._check("start_s", 0.0)
        self._check("change_s", SHORTEST_TIME_S)
        self._check("hold_s", 0.0)

    def angle(self, t: np.ndarray) -> np.ndarray:
        """Return the reference angle [rad] at times ``t`` [s]."""
        u = np.clip((t - self.start_s) / self.change_s, 0.0, 1.0)
        blended = smooth_step(u, 0.0, BLEND) * smooth_step(1.0 - u, 0.0, BLEND)
        return np.radians(self.angle_deg) * blended * np.sin(2.0 * np.pi * u)

    def released(self, t: np.ndarray) -> np.ndarray:
        """Return true before the hands take the wheel, and after they have let it go."""
        t = np.asarray(t)
        return (t < self.start_s) | (t >= self.start_s + self.change_s + self.hold_s)
