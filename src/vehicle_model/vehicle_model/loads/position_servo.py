"""The load cylinder as a position servo: the rack is moved, and the force it takes is measured."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from vehicle_model.loads.base import Load, LoadError


@dataclass(frozen=True)
class PositionServo(Load):
    """A stiff servo that moves the rack along a sine, begun smoothly within ``entry_s``.

    The defaults are the source's friction test (section 3.2): 4 mm and 0.5 rad/s.
    """

    kind: ClassVar[str] = "position_servo"

    amplitude_m: float = 0.004
    angular_frequency_rad_s: float = 0.5
    entry_s: float = 2.0
    stiffness_n_m: float = 2e6

    def __post_init__(self) -> None:
        values = (self.amplitude_m, self.angular_frequency_rad_s, self.entry_s, self.stiffness_n_m)
        if not all(math.isfinite(value) and value > 0.0 for value in values):
            raise LoadError("position_servo: every value must be a number greater than 0")

    def force_gains(self, p: Mapping[str, float]) -> np.ndarray:
        """Return the rack force [N] per sideslip, curvature and rack displacement, shape (3,)."""
        return np.array([0.0, 0.0, self.stiffness_n_m])

    def external(self, t: np.ndarray) -> np.ndarray:
        """Return what the moving reference adds to the rack force [N] at times ``t`` [s]."""
        share = np.clip(t / self.entry_s, 0.0, 1.0)
        risen = share * share * (3.0 - 2.0 * share)
        wanted = self.amplitude_m * risen * np.sin(self.angular_frequency_rad_s * t)
        return -self.stiffness_n_m * wanted
