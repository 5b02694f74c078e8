"""A manoeuvre from a file."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import ClassVar

import numpy as np

from driver_model.manoeuvres.base import LARGEST_ANGLE_DEG, Manoeuvre, ManoeuvreError
from steering_core.csv_columns import CsvError, read_columns


@dataclass(frozen=True)
class Table(Manoeuvre):
    """Angles at given times, joined by straight lines; the first and last are held outside.

    It carries the numbers, not the file, so that it travels to a driver on another computer. The
    driver's lead answers to every corner: sample the file finely enough (1 kHz has no corners).
    """

    kind: ClassVar[str] = "table"

    time_s: tuple[float, ...] = (0.0,)
    steering_wheel_angle_deg: tuple[float, ...] = (0.0,)

    def __post_init__(self) -> None:
        times = np.asarray(self.time_s, dtype=np.float64)
        angles = np.asarray(self.steering_wheel_angle_deg, dtype=np.float64)
        if times.ndim != 1 or times.shape != angles.shape or times.size == 0:
            raise ManoeuvreError(
                f"table: {times.size} times for {angles.size} angles; equal numbers, at least one"
            )
        if not (np.isfinite(times).all() and np.isfinite(angles).all()):
            raise ManoeuvreError("table: times and angles must be finite")
        if not (np.diff(times) > 0.0).all():
            at = int(np.argmin(np.diff(times) > 0.0)) + 1
            raise ManoeuvreError(f"table: time_s must increase, entry {at} does not")
        if np.abs(angles).max() > LARGEST_ANGLE_DEG:
            raise ManoeuvreError(f"table: an angle is beyond {LARGEST_ANGLE_DEG:g} deg")

    def angle(self, t: np.ndarray) -> np.ndarray:
        """Return the reference angle [rad] at times ``t`` [s]."""
        return np.radians(np.interp(t, self.time_s, self.steering_wheel_angle_deg))


def load_table(path: str | Path) -> Table:
    """Read a CSV file with the columns ``time_s`` and ``steering_wheel_angle_deg``.

    Raises ManoeuvreError naming file, line and fault.
    """
    names = ("time_s", "steering_wheel_angle_deg")
    try:
        columns = read_columns(path, names, increasing="time_s")
        return Table(*(tuple(columns[name].tolist()) for name in names))
    except CsvError as error:
        raise ManoeuvreError(str(error)) from None
    except ManoeuvreError as error:
        raise ManoeuvreError(f"{path}: {error}") from None
