"""A sine that sweeps a band of frequencies, for frequency responses."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar, Literal

import numpy as np

from driver_model.manoeuvres.base import SHORTEST_TIME_S, Manoeuvre, ManoeuvreError
from driver_model.manoeuvres.shapes import linear_sweep, logarithmic_sweep, smooth_step

SWEEPS = {"linear": linear_sweep, "logarithmic": logarithmic_sweep}
LOWEST_FREQUENCY_HZ = 0.001


@dataclass(frozen=True)
class Chirp(Manoeuvre):
    """A sine whose frequency rises linearly or logarithmically; its amplitude enters smoothly.

    A logarithmic sweep spends equal times in equal ratios of frequency. After ``duration_s`` the
    final frequency goes on.
    """

    kind: ClassVar[str] = "chirp"

    amplitude_deg: float = 10.0
    initial_frequency_hz: float = 0.1
    final_frequency_hz: float = 5.0
    duration_s: float = 20.0
    sweep: Literal["linear", "logarithmic"] = "linear"
    entry_s: float = 1.0

    def __post_init__(self) -> None:
        self._check_angle("amplitude_deg")
        self._check_rising_frequency(LOWEST_FREQUENCY_HZ)
        self._check("duration_s", SHORTEST_TIME_S)
        self._check("entry_s", SHORTEST_TIME_S)
        if self.sweep not in SWEEPS:
            raise ManoeuvreError(f"chirp: sweep is linear or logarithmic, got '{self.sweep}'")

    def angle(self, t: np.ndarray) -> np.ndarray:
        """Return the reference angle [rad] at times ``t`` [s]."""
        cycles = SWEEPS[self.sweep](
            t, self.initial_frequency_hz, self.final_frequency_hz, self.duration_s
        )
        amplitude = np.radians(self.amplitude_deg) * smooth_step(t, 0.0, self.entry_s)
        return amplitude * np.sin(2.0 * np.pi * cycles)
