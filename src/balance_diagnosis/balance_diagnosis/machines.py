"""Three small machines to try the library on: a sliding mass, two tanks, a pendulum with a motor.

Each has a model, and a record of it can be made with any numbers, hidden causes included.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from balance_diagnosis.model import Model
from balance_diagnosis.ode import ode
from balance_diagnosis.priors import between, toleranced
from balance_diagnosis.record import Record


@dataclass(frozen=True)
class Machine:
    """A model, and what its records are made with.

    true: numbers of a specimen. hidden: a visible size of each cause. noise: of each output.
    """

    name: str
    model: Model
    true: Mapping[str, float]
    hidden: Mapping[str, Mapping[str, float]]
    noise: Mapping[str, float]
    period: float
    samples: int

    def record(self, seed: int, name: str = "made", **numbers: float) -> Record:
        """Return a record with the given numbers off nominal, inputs and noise of a seed."""
        draw = np.random.default_rng(seed)
        times = self.period * np.arange(self.samples)
        drive = _drive(times, draw)
        blank = {key: np.zeros(len(times)) for key in self.noise}
        empty = Record(times, {"drive": drive, **blank}, name=name)
        made = self.model.predicted({**self.true, **numbers}, empty).outputs
        noisy = {
            key: made[key] + sd * draw.standard_normal(len(times)) for key, sd in self.noise.items()
        }
        return Record(times, {"drive": drive, **noisy}, name=name)


def _drive(times: np.ndarray, draw: np.random.Generator) -> np.ndarray:
    """Return a sum of slow sines of random phase, of unit deviation."""
    span = times[-1]
    waves = [
        np.sin(2.0 * np.pi * cycles * times / span + draw.uniform(0.0, 2.0 * np.pi))
        for cycles in (3.0, 5.3, 8.7, 14.1, 23.0)
    ]
    return np.sum(waves, axis=0) / math.sqrt(2.5)


def _sliding(x: Any, u: Any, p: Any) -> Any:
    push = 30.0 * u[0] + p.push_offset
    rub = p.coulomb * math.tanh(x[1] / 0.01) + (p.viscous + p.drag * abs(x[1])) * x[1]
    rub += p.breakaway * math.tanh(x[1] / 0.01) * math.exp(-((x[1] / p.slow_speed) ** 2))
    return x[1], (push - rub - p.spring * x[0]) / p.mass


def _slid(x: Any, record: Record, p: Any) -> dict[str, np.ndarray]:
    return {"speed": x.v * (1.0 + p.gain)}


MASS = Machine(
    "sliding mass",
    Model(
        ode(_sliding, _slid, states=("x", "v"), inputs=("drive",), steps=2),
        parameters={
            "mass": toleranced(10.0, 0.1),
            "viscous": toleranced(20.0, 0.4),
            "coulomb": toleranced(8.0, 0.4),
        },
        causes={
            "push offset": {"push_offset": (0.0, -20.0, 20.0)},
            "drag": {"drag": (0.0, 0.0, 60.0)},
            "Stribeck friction": {"breakaway": (0.0, 0.0, 20.0), "slow_speed": (0.1, 0.02, 0.5)},
            "spring": {"spring": (0.0, 0.0, 60.0)},
            "gain of the speed sensor": {"gain": (0.0, -0.3, 0.3)},
        },
    ),
    {"mass": 10.4, "viscous": 18.0, "coulomb": 8.8},
    {
        "push offset": {"push_offset": 5.0},
        "drag": {"drag": 20.0},
        "Stribeck friction": {"breakaway": 8.0, "slow_speed": 0.15},
        "spring": {"spring": 8.0},
        "gain of the speed sensor": {"gain": 0.15},
    },
    {"speed": 0.01},
    0.01,
    2000,
)


def _filling(x: Any, u: Any, p: Any) -> Any:
    upper, lower = max(x[0], 0.0), max(x[1], 0.0)
    flow = p.pump * max(u[0] + 2.0, 0.0) * (1.0 + p.bent * u[0])
    out = p.k1 * math.sqrt(upper)
    over = max(flow - out, 0.0) if upper >= p.brim else 0.0
    down = p.k2 * lower ** (0.5 + p.power)
    return flow - out - over - p.leak * upper, out + p.share * over - down


def _filled(x: Any, record: Record, p: Any) -> dict[str, np.ndarray]:
    return {"level": x.lower + p.level_offset}


TANKS = Machine(
    "two tanks",
    Model(
        ode(_filling, _filled, states=("upper", "lower"), inputs=("drive",), steps=2),
        parameters={
            "k1": between(0.02, 0.5),
            "k2": between(0.02, 0.5),
            "pump": between(0.02, 0.5),
        },
        starts={"upper": between(0.0, 20.0), "lower": between(0.0, 20.0)},
        causes={
            "overflow": {"brim": (60.0, 2.0, 60.0), "share": (0.5, 0.0, 1.0)},
            "pump is not linear": {"bent": (0.0, -0.2, 0.2)},
            "outflow has another power": {"power": (0.0, -0.2, 0.3)},
            "upper tank leaks": {"leak": (0.0, 0.0, 0.05)},
            "level sensor's offset": {"level_offset": (0.0, -2.0, 2.0)},
        },
    ),
    {"k1": 0.1, "k2": 0.12, "pump": 0.12, "upper": 5.0, "lower": 4.0},
    {
        "overflow": {"brim": 8.0, "share": 0.5},
        "pump is not linear": {"bent": 0.1},
        "outflow has another power": {"power": 0.1},
        "upper tank leaks": {"leak": 0.01},
        "level sensor's offset": {"level_offset": 0.8},
    },
    {"level": 0.05},
    4.0,
    1000,
)


def _swinging(x: Any, u: Any, p: Any) -> Any:
    seen = x[0] + p.zero
    torque = p.gain * (u[0] - seen) - 0.6 * x[1]
    limit = p.limit
    torque = min(max(torque, -limit), limit)
    rub = p.viscous * x[1] + p.rub * math.tanh(x[1] / 0.02)
    return x[1], (torque - rub - p.weight * math.sin(x[0]) - p.tilt) / p.inertia


def _swung(x: Any, record: Record, p: Any) -> dict[str, np.ndarray]:
    return {"angle": x.angle + p.zero, "speed": x.turn}


SERVO = Machine(
    "pendulum servo",
    Model(
        ode(_swinging, _swung, states=("angle", "turn"), inputs=("drive",), steps=4),
        parameters={
            "inertia": toleranced(0.2, 0.1),
            "viscous": toleranced(0.3, 0.4),
            "weight": toleranced(2.0, 0.2),
            "gain": toleranced(6.0, 0.05),
        },
        causes={
            "dry friction": {"rub": (0.0, 0.0, 2.0)},
            "the base is tilted": {"tilt": (0.0, -1.0, 1.0)},
            "torque limit": {"limit": (20.0, 1.0, 20.0)},
            "encoder's zero": {"zero": (0.0, -0.5, 0.5)},
        },
    ),
    {"inertia": 0.21, "viscous": 0.26, "weight": 2.1, "gain": 6.1},
    {
        "dry friction": {"rub": 0.4},
        "the base is tilted": {"tilt": 0.4},
        "torque limit": {"limit": 3.5},
        "encoder's zero": {"zero": 0.15},
    },
    {"angle": 0.01, "speed": 0.05},
    0.01,
    2000,
)

MACHINES = {machine.name: machine for machine in (MASS, TANKS, SERVO)}
