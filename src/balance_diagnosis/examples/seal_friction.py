"""Seal friction of a small pneumatic cylinder at four pressures: public data (CC0)."""

import os
import sys
from pathlib import Path

import numpy as np
from scipy.signal import butter, filtfilt

from balance_diagnosis import Model, Record, diagnose, toleranced

PERIOD, LEAST_SPEED, ROUNDED = 0.01, 2e-3, 5e-4  # s, m/s
FILTER = butter(2, 5.0, fs=1.0 / PERIOD)


def force(p, record):
    """Return the piston's force at the measured motion and pressure [N]."""
    x, v, late = record["x"], record["v"], record.times + p.delay
    bar, sign = np.interp(late, record.times, record["bar"]), np.tanh(v / ROUNDED)
    stribeck = p.breakaway * np.exp(-np.abs(v) / p.stribeck_speed)
    friction = sign * (p.coulomb + p.by_pressure * bar + p.along * x + stribeck)
    steady = (p.area + p.curve * bar) * bar + p.offset + p.spring * x
    return {"force": steady + friction + p.viscous * v}


MODEL = Model(
    force,
    parameters={
        "area": toleranced(49.1, 0.05),
        "coulomb": toleranced(7.0, plus_minus=6.0),
        "offset": toleranced(0.0, plus_minus=5.0),
    },
    causes={
        "friction grows with pressure": {"by_pressure": (0.0, -5.0, 5.0)},
        "viscous friction": {"viscous": (0.0, -2000.0, 2000.0)},
        "spring": {"spring": (0.0, -1000.0, 1000.0)},
        "friction along the stroke": {"along": (0.0, -1000.0, 1000.0)},
        "Stribeck friction": {"breakaway": (0.0, 0.0, 50.0), "stribeck_speed": (3e-3, 1e-4, 0.05)},
        "load cell is not linear": {"curve": (0.0, -2.0, 2.0)},
        "pressure sensor is late": {"delay": (0.0, -0.3, 0.3)},
    },
    units={"area": "N/bar", "by_pressure": "N/bar", "coulomb": "N", "offset": "N", "delay": "s"},
    name="seal friction",
)


def record(folder, seal, bar):
    """Return the record of one pressure: force [N] against position [m] and pressure [bar]."""
    table = np.genfromtxt(Path(folder) / f"{seal}_{bar}bar.csv")
    table = table[np.r_[True, np.diff(table[:, 0]) > 0.0]]
    told = table[:, 0] / 1e3
    times = np.arange(told[0], told[-1], PERIOD)
    x, pressure, pull = (filtfilt(*FILTER, np.interp(times, told, table[:, k])) for k in (4, 5, 6))
    v = np.gradient(1e-3 * x, PERIOD)
    gaps = np.diff(told)[np.searchsorted(told, times, side="right") - 1] > 0.05
    pull[gaps | (np.abs(v) < LEAST_SPEED)] = np.nan
    pull[:100] = pull[-100:] = np.nan
    channels = {"x": 1e-3 * x, "v": v, "bar": pressure, "force": pull}
    return Record(times, channels, {"force": "N", "bar": "bar"}, name=f"{seal} {bar} bar")


if __name__ == "__main__":
    every = [record(os.environ["STEER_SEALS_DATA"], "O-ring", bar) for bar in (1, 3, 5, 7)]
    halves = [[r.part(0.0, 0.5) for r in every], [r.part(0.5, 1.0) for r in every]]
    print(diagnose(MODEL, fit=halves[0], holdout=halves[1]).write(sys.argv[1]))
