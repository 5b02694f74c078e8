"""What every manoeuvre is: a reference angle over time, and when the hands leave the wheel."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import ClassVar

import numpy as np

# Beyond any steering gear's stop; an amplitude above it is a mistake in the unit.
LARGEST_ANGLE_DEG = 1080.0
# Ten ticks a period.
LARGEST_FREQUENCY_HZ = 100.0
SHORTEST_TIME_S = 0.001


class ManoeuvreError(ValueError):
    """A manoeuvre that does not exist, or a value that it cannot have."""


@dataclass(frozen=True)
class Manoeuvre:
    """A steering wheel angle to follow. Positive angles turn to the left (ISO 8855).

    Values are checked when the manoeuvre is made; a wrong one raises ManoeuvreError.
    """

    kind: ClassVar[str]
    # Read where a schema library validates these dataclasses: unknown names are refused there too.
    __pydantic_config__: ClassVar[dict[str, str]] = {"extra": "forbid"}

    def angle(self, t: np.ndarray) -> np.ndarray:
        """Return the reference angle [rad] at times ``t`` [s], element by element, t >= 0."""
        raise NotImplementedError

    def released(self, t: np.ndarray) -> np.ndarray:
        """Return true where the hands are off the wheel at times ``t`` [s]; never, by default."""
        return np.zeros(np.shape(t), dtype=np.bool_)

    def _check(self, name: str, lowest: float, highest: float = math.inf) -> None:
        value = getattr(self, name)
        if isinstance(value, bool) or not isinstance(value, int | float):
            raise ManoeuvreError(f"{self.kind}: {name} '{value}' is not a number")
        if not math.isfinite(value):
            raise ManoeuvreError(f"{self.kind}: {name} must be finite, got {value}")
        if not lowest <= value <= highest:
            limits = (
                f"from {lowest:g} to {highest:g}"
                if math.isfinite(highest)
                else f"at least {lowest:g}"
            )
            raise ManoeuvreError(f"{self.kind}: {name} must be {limits}, got {value:g}")

    def _check_angle(self, name: str) -> None:
        self._check(name, -LARGEST_ANGLE_DEG, LARGEST_ANGLE_DEG)

    def _check_rising_frequency(self, lowest: float) -> None:
        """Check the fields ``initial_frequency_hz`` and ``final_frequency_hz`` of a sweep."""
        self._check("initial_frequency_hz", lowest, LARGEST_FREQUENCY_HZ)
        self._check("final_frequency_hz", 0.0, LARGEST_FREQUENCY_HZ)
        initial, final = (getattr(self, f"{end}_frequency_hz") for end in ("initial", "final"))
        if final < initial:
            raise ManoeuvreError(
                f"{self.kind}: final_frequency_hz {final:g} is below initial_frequency_hz "
                f"{initial:g}; the frequency rises"
            )
