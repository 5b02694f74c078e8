"""The main manoeuvre of the bench: a sine around straight ahead, faster and faster."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from driver_model.manoeuvres.base import SHORTEST_TIME_S, Manoeuvre
from driver_model.manoeuvres.shapes import linear_sweep


@dataclass(frozen=True)
class OnCentre(Manoeuvre):
    """A sine of constant amplitude whose frequency rises linearly; it stays there afterwards.

    30 degrees at 2 Hz reach 377 deg/s at the end; 400 deg/s needs a final frequency of 2.12 Hz.
    From an initial frequency of 0 the wheel starts with zero speed. With the defaults the sweep
    ends after ten whole cycles, at its largest speed.
    """

    kind: ClassVar[str] = "on_centre"

    amplitude_deg: float = 30.0
    initial_frequency_hz: float = 0.0
    final_frequency_hz: float = 2.0
    duration_s: float = 10.0

    def __post_init__(self) -> None:
        self._check_angle("amplitude_deg")
        self._check_rising_frequency(0.0)
        self._check("duration_s", SHORTEST_TIME_S)

    def angle(self, t: np.ndarray) -> np.ndarray:
        """Return the reference angle [rad] at times ``t`` [s]."""
        cycles = linear_sweep(
            t, self.initial_frequency_hz, self.final_frequency_hz, self.duration_s
        )
        return np.radians(self.amplitude_deg) * np.sin(2.0 * np.pi * cycles)
