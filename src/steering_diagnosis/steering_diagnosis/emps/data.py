"""The benchmark's MATLAB files: position and drive signal of one experiment."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import numpy as np

from steering_core.errors import BenchError

PERIOD_S = 1e-3
ESTIMATION, PULSES = "DATA_EMPS.mat", "DATA_EMPS_PULSES.mat"
NEEDED = ("qm", "vir", "gtau")


@dataclass(frozen=True, repr=False)
class Axis:
    """One record at 1 kHz: position [m] and motor force [N], (n,) each. path: of the file."""

    position: np.ndarray
    force: np.ndarray
    path: Path


def read_axis(path: str | Path) -> Axis:
    """Read one record. The motor's force is ``gtau`` times the drive signal ``vir``.

    BenchError names the file and what it lacks.
    """
    from scipy.io import loadmat

    path = Path(path)
    if not path.is_file():
        raise BenchError(f"there is no record '{path}'")
    try:
        content = loadmat(path, squeeze_me=True)
    except (ValueError, OSError, NotImplementedError) as error:
        raise BenchError(f"'{path}' cannot be read as a MAT file: {error}") from None
    for name in NEEDED:
        if name not in content:
            raise BenchError(f"'{path}' is no record of the axis: it lacks '{name}'")
    position = np.asarray(content["qm"], np.float64)
    force = float(content["gtau"]) * np.asarray(content["vir"], np.float64)
    if position.shape != force.shape or len(position) < 2000:
        raise BenchError(f"'{path}': position and drive signal do not belong together")
    return Axis(position, force, path)
