"""An electro-mechanical axis: a public benchmark (Janot, Gautier, Brunot 2019)."""

import os
import sys
from pathlib import Path

import numpy as np
from scipy.io import loadmat
from scipy.signal import butter, filtfilt

from balance_diagnosis import Model, Record, diagnose, toleranced

STANDSTILL, LEAST_SPEED = 1e-4, 5e-3  # m/s: signs are rounded below, and nothing is judged
FILTER = butter(4, 100.0, fs=1000.0)


def force(p, record):
    """Return the force that the motion needs [N]."""
    x, v, a = record["x"], record["v"], record["a"]
    sign, speed = record["sign"], np.abs(v)
    friction = (p.viscous + p.by_direction * sign + p.drag * speed) * v
    friction += (p.coulomb + p.along * x) * sign + p.coulomb_by_direction * np.abs(sign)
    friction += p.breakaway * sign * np.exp(-((v / p.stribeck_speed) ** 2))
    return {"force": p.mass * a + friction + p.offset + p.spring * x}


MODEL = Model(
    force,
    parameters={
        "mass": toleranced(95.0, 0.2),
        "viscous": toleranced(200.0, 0.5),
        "coulomb": toleranced(20.0, 0.5),
    },
    causes={
        "force offset": {"offset": (0.0, -100.0, 100.0)},
        "viscous friction by direction": {"by_direction": (0.0, -1000.0, 1000.0)},
        "Coulomb friction by direction": {"coulomb_by_direction": (0.0, -100.0, 100.0)},
        "Stribeck friction": {
            "breakaway": (0.0, 0.0, 200.0),
            "stribeck_speed": (0.01, 1e-3, 0.1),
        },
        "drag": {"drag": (0.0, -5000.0, 5000.0)},
        "friction along the screw": {"along": (0.0, -1000.0, 1000.0)},
        "spring": {"spring": (0.0, -1000.0, 1000.0)},
    },
    units={
        "mass": "kg",
        "viscous": "N s/m",
        "by_direction": "N s/m",
        "coulomb": "N",
        "offset": "N",
    },
    name="electro-mechanical axis",
)


def records(folder):
    """Return the estimation record and the one with pulses."""
    made = []
    for name in ("DATA_EMPS", "DATA_EMPS_PULSES"):
        data = loadmat(Path(folder) / f"{name}.mat", squeeze_me=True)
        x, pull = (filtfilt(*FILTER, s) for s in (data["qm"], data["gtau"] * data["vir"]))
        v = np.gradient(x, 1e-3)
        judged = np.where((np.abs(v) > LEAST_SPEED), pull, np.nan)
        judged[:200] = judged[-200:] = np.nan
        moved = {"x": x, "v": v, "a": np.gradient(v, 1e-3), "sign": np.tanh(v / STANDSTILL)}
        made.append(
            Record(1e-3 * np.arange(len(x)), {**moved, "force": judged}, {"force": "N"}, name=name)
        )
    return made


if __name__ == "__main__":
    fit, held = records(os.environ["STEER_EMPS_DATA"])
    print(diagnose(MODEL, fit=[fit], holdout=[held]).write(sys.argv[1]))
