"""The two measured records of the EMPS axis (Janot, Gautier, Brunot 2019)."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import numpy as np
from scipy import io, signal

from steering_core.errors import BenchError

PERIOD_S = 1e-3
ESTIMATION, PULSES = "DATA_EMPS.mat", "DATA_EMPS_PULSES.mat"
BANDWIDTH_HZ = 40.0
"""Of the zero-phase low-pass, alike on force and motion: speed and acceleration need one."""
ORDER = 4


@dataclass(frozen=True, repr=False)
class Axis:
    """Low-passed force of the motor [N], position [m], speed [m/s], acceleration [m/s2], (n,)."""

    force: np.ndarray
    position: np.ndarray
    speed: np.ndarray
    acceleration: np.ndarray


def load(path: Path) -> Axis:
    """Read one record. BenchError where the file is missing or is something else."""
    if not path.is_file():
        raise BenchError(f"{path} is not there: give the folder with {ESTIMATION} and {PULSES}")
    try:
        data = io.loadmat(path)
        position = np.ravel(data["qm"]).astype(float)
        force = np.ravel(data["vir"]).astype(float) * float(np.ravel(data["gtau"])[0])
    except (KeyError, ValueError, NotImplementedError) as error:
        raise BenchError(f"{path} is no EMPS record: qm, vir and gtau are needed") from error
    smooth = low_pass(position)
    speed = np.gradient(smooth, PERIOD_S)
    return Axis(low_pass(force), smooth, speed, np.gradient(speed, PERIOD_S))


def low_pass(values: np.ndarray) -> np.ndarray:
    """Return values through the zero-phase low-pass, (n,)."""
    sections = signal.butter(ORDER, 2.0 * BANDWIDTH_HZ * PERIOD_S, output="sos")
    return np.asarray(signal.sosfiltfilt(sections, values))
