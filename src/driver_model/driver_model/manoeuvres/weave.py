"""A sine of one frequency around straight ahead."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from driver_model.manoeuvres.base import LARGEST_FREQUENCY_HZ, SHORTEST_TIME_S, Manoeuvre
from driver_model.manoeuvres.shapes import smooth_step


@dataclass(frozen=True)
class Weave(Manoeuvre):
    """A sine of constant frequency whose amplitude enters smoothly within ``entry_s``."""

    kind: ClassVar[str] = "weave"

    amplitude_deg: float = 20.0
    frequency_hz: float = 0.2
    entry_s: float = 1.0

    def __post_init__(self) -> None:
        self._check_angle("amplitude_deg")
        self._check("frequency_hz", 0.0, LARGEST_FREQUENCY_HZ)
        self._check("entry_s", SHORTEST_TIME_S)

    def angle(self, t: np.ndarray) -> np.ndarray:
        """Return the reference angle [rad] at times ``t`` [s]."""
        amplitude = np.radians(self.amplitude_deg) * smooth_step(t, 0.0, self.entry_s)
        return amplitude * np.sin(2.0 * np.pi * self.frequency_hz * t)
