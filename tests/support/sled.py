"""A sled on a spring with friction: a small machine to try the diagnosis engine on.

The replay integrates with a fixed step and smooth friction; the truth has other code: another
integrator, a bristle (Dahl) for the friction, and parameters of one specimen.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field

import numba
import numpy as np
from scipy import signal

from steering_diagnosis.engine.model import Hypothesis, HypothesisParameter, Nuisance, Output

PERIOD_S = 1e-3
NOMINAL = {"mass": 3.0, "stiffness": 4e3, "damping": 60.0, "friction": 25.0}
TOLERANCE = {"mass": 0.15, "stiffness": 200.0, "damping": 9.0, "friction": 5.0}
SENSORS = {"position_offset": 4e-5, "force_offset": 2.0, "force_gain": 0.01}
NOISE = (2e-5, 1.0, 1e-3)
"""Standard deviations of position [m], spring force [N] and speed [m/s]."""

OUTPUTS = (
    Output("position", "m", "sled"),
    Output("force", "N", "spring"),
    Output("speed", "m/s", "sled"),
)
NUISANCES = tuple(Nuisance(n, "SI", v, TOLERANCE[n]) for n, v in NOMINAL.items()) + tuple(
    Nuisance(n, "SI", 0.0, t) for n, t in SENSORS.items()
)


def _one(name: str, low: float, high: float, typical: float, *competes: str) -> Hypothesis:
    parameter = HypothesisParameter("size", "SI", 0.0, low, high, typical)
    return Hypothesis(name, name, "sled", (parameter,), competes)


HYPOTHESES = {
    h.name: h
    for h in (
        _one("friction_level", -20.0, 80.0, 20.0, "friction"),
        _one("friction_asymmetry", -30.0, 30.0, 10.0),
        _one("drag", 0.0, 4000.0, 600.0),
        _one("viscous_asymmetry", -100.0, 100.0, 40.0),
        _one("position_friction", -3000.0, 3000.0, 500.0),
        _one("position_delay", 0.0, 0.05, 0.01),
        _one("force_sensor_offset", -60.0, 60.0, 10.0, "force_offset"),
        _one("load_offset", -60.0, 60.0, 10.0),
        _one("hardening", 0.0, 1e7, 1e6),
        Hypothesis(
            "stribeck",
            "stribeck",
            "sled",
            (
                HypothesisParameter("excess", "N", 0.0, 0.0, 60.0, 15.0),
                HypothesisParameter("speed", "m/s", 0.02, 0.003, 0.3, 0.02, shape=True),
            ),
        ),
        Hypothesis(
            "backlash",
            "backlash",
            "spring",
            (HypothesisParameter("gap", "m", 0.0, 0.0, 5e-3, 5e-4),),
        ),
    )
}
SLOTS = tuple(HYPOTHESES)


@numba.njit(cache=False)
def _replay(drive, load, mass, stiffness, damping, friction, e, speed_s):  # type: ignore[no-untyped-def]
    n = len(drive)
    out = np.empty((n, 3))
    x, v = drive[0], 0.0
    h = PERIOD_S / 5
    for i in range(n):
        stretch = drive[i] - x
        gap = e[10]
        slack = stretch - min(max(stretch, -gap), gap)
        spring = stiffness * slack + e[8] * slack**3
        out[i, 0], out[i, 1], out[i, 2] = x, spring, v
        for _ in range(5):
            stretch = drive[i] - x
            slack = stretch - min(max(stretch, -gap), gap)
            spring = stiffness * slack + e[8] * slack**3
            s = np.tanh(v / 2e-3)
            level = friction + e[0] + e[4] * abs(x) + e[9] * np.exp(-((v / speed_s) ** 2))
            resist = level * s + e[1] * abs(s) + e[2] * v * abs(v) + e[3] * abs(v)
            v += h * (spring - damping * v - resist - load[i] - e[7]) / mass
            x += h * v
    return out


@dataclass(frozen=True)
class SledReplay:
    """The nominal sled bound to a record of drive, load and measured outputs."""

    drive: np.ndarray
    load: np.ndarray
    measured: np.ndarray
    outputs: tuple[Output, ...] = OUTPUTS
    nuisances: tuple[Nuisance, ...] = NUISANCES
    hypotheses: Mapping[str, Hypothesis] = field(default_factory=lambda: HYPOTHESES)
    period_s: float = PERIOD_S

    def residuals(
        self, nuisances: Mapping[str, float], effects: Mapping[str, Mapping[str, float]]
    ) -> np.ndarray:
        p = {**NOMINAL, **dict.fromkeys(SENSORS, 0.0), **nuisances}
        e = np.zeros(len(SLOTS))
        speed = 0.02
        for name, values in effects.items():
            e[SLOTS.index(name)] = next(iter(values.values()))
            speed = values.get("speed", speed)
        mechanics = [p[n] for n in NOMINAL]
        predicted = _replay(self.drive, self.load, *mechanics, e, speed)
        if e[SLOTS.index("position_delay")] > 0.0:
            time = np.arange(len(self.drive)) * PERIOD_S
            late = time - e[SLOTS.index("position_delay")]
            predicted[:, 0] = np.interp(late, time, predicted[:, 0])
        predicted[:, 0] += p["position_offset"]
        predicted[:, 1] = (
            predicted[:, 1] * (1.0 + p["force_gain"])
            + p["force_offset"]
            + e[SLOTS.index("force_sensor_offset")]
        )
        return self.measured - predicted

    def shaken(
        self, nuisances: Mapping[str, float], effects: Mapping[str, Mapping[str, float]]
    ) -> np.ndarray:
        return np.zeros_like(self.measured)

    def noise(self) -> np.ndarray:
        return np.zeros(self.measured.shape[1])

    def states(self) -> Mapping[str, np.ndarray]:
        return {
            "position": self.measured[:, 0],
            "drive": self.drive,
            "speed": np.gradient(signal.savgol_filter(self.drive, 51, 2), PERIOD_S),
            "load": self.load,
        }


@numba.njit(cache=False)
def _truth(drive, load, p, asym, drag, excess, speed_s, gap, ripple, x_offset):  # type: ignore[no-untyped-def]
    mass, stiffness, damping, friction = p
    n = len(drive)
    out = np.empty((n, 3))
    x, v, bristle = drive[0], 0.0, 0.0
    h = PERIOD_S / 40
    for i in range(n):
        stretch = drive[i] - x
        spring = stiffness * (stretch - min(max(stretch, -gap), gap))
        out[i, 0], out[i, 1], out[i, 2] = x, spring, v
        for _ in range(40):
            level = friction + excess / (1.0 + (v / speed_s) ** 2)
            bristle += h * v * (1.0 - np.sign(v) * bristle / level * 2e6)
            bristle = min(max(bristle, -level / 2e6), level / 2e6)
            resist = 2e6 * bristle * (1.0 + asym / friction * np.sign(bristle)) + drag * v * abs(v)
            resist += ripple * np.sin(x * 900.0)
            stretch = drive[i] - x
            spring = stiffness * (stretch - min(max(stretch, -gap), gap))
            v += h * (spring - damping * v - resist - load[i] - x_offset) / mass
            x += h * v
    return out


def record(seed: int, seconds: float = 12.0, **hidden: float) -> SledReplay:
    """Return a replay of a specimen with something hidden in it, from a seed.

    hidden: friction_level, friction_asymmetry, drag, stribeck, backlash, position_delay,
    force_sensor_offset, load_offset, ripple (in no catalogue), spread (of the specimen, 1).
    """
    rng = np.random.default_rng(seed)
    n = int(seconds / PERIOD_S)
    time = np.arange(n) * PERIOD_S
    drive = np.zeros(n)
    for f in (0.2, 0.37, 0.8, 1.7, 3.1):
        drive += rng.uniform(0.4, 1.0) / f**0.7 * np.sin(2 * np.pi * (f * time + rng.random()))
    drive *= 0.03 / np.abs(drive).max()
    load = signal.lfilter(*signal.butter(2, 0.004), 600.0 * rng.standard_normal(n))
    spread = hidden.get("spread", 1.0)
    specimen = [
        NOMINAL[k] + spread * np.clip(0.5 * rng.standard_normal(), -1, 1) * TOLERANCE[k]
        for k in NOMINAL
    ]
    specimen[3] += hidden.get("friction_level", 0.0)
    true = _truth(
        drive,
        load,
        np.array(specimen),
        hidden.get("friction_asymmetry", 0.0),
        hidden.get("drag", 0.0),
        hidden.get("stribeck", 0.0),
        0.02,
        hidden.get("backlash", 0.0),
        hidden.get("ripple", 0.0),
        hidden.get("load_offset", 0.0),
    )
    late = hidden.get("position_delay", 0.0)
    true[:, 0] = np.interp(time - late, time, true[:, 0])
    sensors = [spread * np.clip(0.5 * rng.standard_normal(), -1, 1) * t for t in SENSORS.values()]
    true[:, 0] += sensors[0]
    true[:, 1] = true[:, 1] * (1.0 + sensors[2]) + sensors[1]
    true[:, 1] += hidden.get("force_sensor_offset", 0.0)
    for j, sd in enumerate(NOISE):
        colour = signal.lfilter([1.0], [1.0, -0.9], rng.standard_normal(n)) * np.sqrt(1 - 0.81)
        drift = np.cumsum(rng.standard_normal(n)) / np.sqrt(n)
        true[:, j] += sd * (0.7 * colour + 0.5 * rng.standard_normal(n) + 0.5 * drift)
    true[:, 0] = np.round(true[:, 0] / 1e-5) * 1e-5
    return SledReplay(drive, load, true)
