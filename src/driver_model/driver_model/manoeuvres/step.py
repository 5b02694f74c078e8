"""From straight ahead to an angle, fast."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from driver_model.manoeuvres.base import SHORTEST_TIME_S, Manoeuvre
from driver_model.manoeuvres.shapes import smooth_step


@dataclass(frozen=True)
class Step(Manoeuvre):
    """A step with a finite, smooth rise that begins at ``start_s``; then the angle is held."""

    kind: ClassVar[str] = "step"

    angle_deg: float = 30.0
    start_s: float = 0.5
    rise_s: float = 0.2

    def __post_init__(self) -> None:
        self._check_angle("angle_deg")
        self._check("start_s", 0.0)
        self._check("rise_s", SHORTEST_TIME_S)

    def angle(self, t: np.ndarray) -> np.ndarray:
        """Return the reference angle [rad] at times ``t`` [s]."""
        return np.radians(self.angle_deg) * smooth_step(t, self.start_s, self.rise_s)
