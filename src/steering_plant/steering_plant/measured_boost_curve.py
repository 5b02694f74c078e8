"""A measured boost curve in place of the formula: its points, and the piecewise cubic through them.

A node takes the points as parameters and never the file, which another computer does not have.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path

import numpy as np

from steering_core.csv_columns import read_columns
from steering_core.naming import unknown
from steering_core.parameters import ParameterError
from steering_plant.boost_curve import FORMULA

COLUMNS = ("torsion_bar_torque_Nm", "load_pressure_Pa")
FEWEST_POINTS = 4

Points = Mapping[str, Sequence[float]]
"""Points of a curve by COLUMNS: torques [N m] and load pressures [Pa]."""


def read_boost_curve(path: str | Path) -> dict[str, list[float]]:
    """Return the points in a CSV file with the header ``torsion_bar_torque_Nm,load_pressure_Pa``.

    Raises CsvError or ParameterError naming the file.
    """
    columns = read_columns(path, COLUMNS, increasing=COLUMNS[0])
    points = {name: values.tolist() for name, values in columns.items()}
    try:
        boost_table(points)
    except ParameterError as error:
        raise ParameterError(f"{path}: {error}") from None
    return points


def boost_table(points: Points) -> np.ndarray:
    """Return the piecewise cubic through ``points``, shape (n, 5); FORMULA without any.

    Torques rise from negative to positive, pressures never fall. Rows of the result: start of the
    piece [N m], then its coefficients from the third to the zeroth power (monotone,
    Fritsch-Carlson); ends continue linearly. Raises ParameterError.
    """
    if not points:
        return FORMULA
    from scipy.interpolate import PchipInterpolator  # takes half a second, and few runs need it

    torque, pressure = _checked(points)
    curve = PchipInterpolator(torque, pressure)
    slopes = curve.derivative()(torque[[0, -1]])
    before = [torque[0] - 1.0, 0.0, 0.0, slopes[0], pressure[0] - slopes[0]]
    after = [torque[-1], 0.0, 0.0, slopes[1], pressure[-1]]
    return np.vstack([before, np.column_stack([torque[:-1], curve.c.T]), after])


def _checked(points: Points) -> tuple[np.ndarray, np.ndarray]:
    for name in points:
        if name not in COLUMNS:
            raise ParameterError(unknown("column of a boost curve", name, COLUMNS))
    torque, pressure = (np.asarray(points.get(name, ()), dtype=np.float64) for name in COLUMNS)
    if len(torque) != len(pressure):
        raise ParameterError(f"{len(torque)} torques for {len(pressure)} load pressures")
    if not np.isfinite([torque, pressure]).all() or not np.all(np.diff(torque) > 0.0):
        raise ParameterError("the numbers must be finite, and the torques increase")
    if len(torque) < FEWEST_POINTS or np.any(np.diff(pressure) < 0.0):
        raise ParameterError(
            f"needs {FEWEST_POINTS} points or more, with a pressure that never falls"
        )
    if not torque[0] < 0.0 < torque[-1]:
        raise ParameterError("the torque must run from negative to positive values")
    return torque, pressure
