"""Hold an angle, then let go."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from driver_model.manoeuvres.base import SHORTEST_TIME_S, Manoeuvre, ManoeuvreError
from driver_model.manoeuvres.shapes import smooth_step


@dataclass(frozen=True)
class FreeRelease(Manoeuvre):
    """Turn smoothly to ``angle_deg``, hold it, and let the wheel go at ``release_s`` for good.

    The reference stays at the held angle; after the release nobody follows it.
    """

    kind: ClassVar[str] = "free_release"

    angle_deg: float = 30.0
    start_s: float = 0.5
    rise_s: float = 1.0
    release_s: float = 3.0

    def __post_init__(self) -> None:
        self._check_angle("angle_deg")
        self._check("start_s", 0.0)
        self._check("rise_s", SHORTEST_TIME_S)
        self._check("release_s", 0.0)
        reached = self.start_s + self.rise_s
        if self.release_s < reached:
            raise ManoeuvreError(
                f"free_release: release_s {self.release_s:g} comes before the angle is reached "
                f"at start_s + rise_s = {reached:g}"
            )

    def angle(self, t: np.ndarray) -> np.ndarray:
        """Return the reference angle [rad] at times ``t`` [s]."""
        return np.radians(self.angle_deg) * smooth_step(t, self.start_s, self.rise_s)

    def released(self, t: np.ndarray) -> np.ndarray:
        """Return true from ``release_s`` on."""
        return np.asarray(t) >= self.release_s
