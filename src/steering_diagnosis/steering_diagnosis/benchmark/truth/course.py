"""Manoeuvres and loads of the benchmark, drawn from a seed."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.interpolate import CubicSpline

KINDS = ("sweep", "chirp", "weave", "ramps", "steps", "amplitudes", "large", "park")
LOADS = ("bicycle", "dry_park", "none", "table")


@dataclass(frozen=True, repr=False)
class Course:
    """What the driver wants and what pushes back.

    angle: (n,) [rad]. load: kind of vehicle_model.loads. force: (n,) [N], for a table.
    """

    kind: str
    load: str
    angle: np.ndarray
    force: np.ndarray


def draw_course(
    random: np.random.Generator, seconds: float, kind: str | None = None, load: str | None = None
) -> Course:
    """Return a manoeuvre with a load that suits it."""
    kind = str(random.choice(KINDS)) if kind is None else kind
    if load is None:
        load = (
            "dry_park"
            if kind == "park"
            else str(random.choice(["bicycle", "table", "none"], p=[0.45, 0.45, 0.1]))
        )
        load = "none" if kind == "large" else load
    time = np.arange(round(seconds * 1000)) * 1e-3
    angle = np.radians(_angle(random, kind, time)) * np.minimum(time / 0.5, 1.0) ** 2
    return Course(
        kind, load, angle, _force(random, time) if load == "table" else np.zeros(len(time))
    )


def _angle(random: np.random.Generator, kind: str, t: np.ndarray) -> np.ndarray:
    """Return the wanted steering wheel angle [deg]; amplitude dithered so that no two are alike."""
    size, end = random.uniform(0.8, 1.2), t[-1]
    if kind == "sweep":
        return 28.0 * size * np.sin(np.pi * random.uniform(1.6, 2.2) * t * t / end)
    if kind == "chirp":
        return (
            10.0
            * size
            * np.sin(2.0 * np.pi * (0.2 * t + 0.5 * random.uniform(3.0, 5.0) * t * t / end))
        )
    if kind == "weave":
        rate = random.uniform(0.3, 0.6)
        return 25.0 * size * np.sin(2.0 * np.pi * rate * t) + 4.0 * np.sin(
            2.0 * np.pi * random.uniform(1.5, 3.0) * t
        )
    if kind == "ramps":
        return _through(random, t, 32.0 * size, random.uniform(0.9, 1.5), corner=0.15)
    if kind == "steps":
        return _through(random, t, 22.0 * size, random.uniform(0.8, 1.2), corner=0.12, hold=True)
    if kind == "amplitudes":
        steps = np.array([4.0, 10.0, 20.0, 35.0, 12.0, 28.0])
        envelope = np.interp(t, np.linspace(0.0, end, 6), random.permutation(steps) * size)
        return envelope * np.sin(2.0 * np.pi * random.uniform(0.6, 1.1) * t)
    if kind == "large":
        return 320.0 * size * np.sin(2.0 * np.pi * random.uniform(0.12, 0.18) * t)
    return 24.0 * size * np.sin(2.0 * np.pi * random.uniform(0.3, 0.5) * t) + 4.0 * np.sin(
        2.0 * np.pi * 1.7 * t
    )


def _through(
    random: np.random.Generator,
    t: np.ndarray,
    size: float,
    every: float,
    corner: float,
    hold: bool = False,
) -> np.ndarray:
    """Return ramps (or steps that are held) through random angles, with rounded corners."""
    knots = np.arange(0.0, t[-1] + 2.0 * every, every)
    values = (
        size * random.uniform(0.4, 1.0, len(knots)) * np.where(np.arange(len(knots)) % 2, -1, 1)
    )
    values[0] = 0.0
    raw = (
        values[np.searchsorted(knots, t, side="right") - 1] if hold else np.interp(t, knots, values)
    )
    width = max(round(corner * 1000), 1)
    window = np.hanning(width + 2)[1:-1]
    padded = np.concatenate([np.full(width, raw[0]), raw, np.full(width, raw[-1])])
    return np.convolve(padded, window / window.sum(), mode="same")[width:-width]


def _force(random: np.random.Generator, t: np.ndarray) -> np.ndarray:
    """Return a force [N] as a load cylinder gives it: smooth, to and fro, up to 1.5 kN."""
    knots = np.arange(0.0, t[-1] + 2.0, random.uniform(0.5, 1.0))
    values = random.uniform(-1500.0, 1500.0, len(knots))
    values[0] = 0.0
    return np.asarray(CubicSpline(knots, values)(t))
