"""A rack force from a file."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import ClassVar

import numpy as np

from steering_core.csv_columns import CsvError, read_columns
from vehicle_model.loads.base import Load, LoadError


@dataclass(frozen=True)
class Table(Load):
    """Rack forces at given times, joined by straight lines; the first and last are held outside.

    It carries the numbers, not the file, so that it travels to a node on another computer. The
    force does not depend on the rack; the vehicle's motion follows the rack at the data sheet's
    speed.
    """

    kind: ClassVar[str] = "table"
    moves: ClassVar[bool] = True

    time_s: tuple[float, ...] = (0.0,)
    rack_force_n: tuple[float, ...] = (0.0,)

    def __post_init__(self) -> None:
        times = np.asarray(self.time_s, dtype=np.float64)
        forces = np.asarray(self.rack_force_n, dtype=np.float64)
        if times.ndim != 1 or times.shape != forces.shape or times.size == 0:
            raise LoadError(
                f"table: {times.size} times for {forces.size} forces; equal numbers, at least one"
            )
        if not (np.isfinite(times).all() and np.isfinite(forces).all()):
            raise LoadError("table: times and forces must be finite")
        if not (np.diff(times) > 0.0).all():
            at = int(np.argmin(np.diff(times) > 0.0)) + 1
            raise LoadError(f"table: time_s must increase, entry {at} does not")

    def external(self, t: np.ndarray) -> np.ndarray:
        """Return the file's rack force [N] at times ``t`` [s]."""
        return np.interp(t, self.time_s, self.rack_force_n)


def load_table(path: str | Path) -> Table:
    """Read a CSV file with the columns ``time_s`` and ``rack_force_N``.

    Positive forces oppose positive rack displacement. Raises LoadError naming file, line and fault.
    """
    try:
        columns = read_columns(path, ("time_s", "rack_force_N"), increasing="time_s")
    except CsvError as error:
        raise LoadError(str(error)) from None
    return Table(tuple(columns["time_s"].tolist()), tuple(columns["rack_force_N"].tolist()))
