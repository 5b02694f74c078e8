"""What sensors add: white and coloured noise, slow drift, and decoys that nobody would name."""

from __future__ import annotations

import numpy as np
from scipy.signal import lfilter

from steering_diagnosis.data.channels import MEASURED

WHITE = np.array([1.5e-4, 4e-3, 3e-3, 2.5e3, 2.5e3, 2.5e3, 1.5e-6, 2e-4, 2.0])
"""Standard deviation of a sample, order of MEASURED, SI."""

COLOURED = 0.5
"""Standard deviation of the coloured part over the white one."""

RESOLUTION = np.array([1e-4, 2e-3, 2e-3, 1e3, 1e3, 1e3, 1e-6, 1e-4, 1.0])
"""Steps of the converters, SI."""

DRIFT = 0.1
"""Standard deviation of the drift over the sensor's offset tolerance."""


def disturbance(random: np.random.Generator, ticks: int) -> np.ndarray:
    """Return what is added to the measured values, (ticks, 9), SI."""
    white = random.standard_normal((ticks, len(WHITE)))
    total = WHITE * white
    for i, channel in enumerate(MEASURED.values()):
        total[:, i] += WHITE[i] * COLOURED * _coloured(random, ticks, random.uniform(5.0, 60.0))
        total[:, i] += DRIFT * channel.offset * _drift(random, ticks)
    hum = random.uniform(0.1, 0.4, len(WHITE)) * WHITE
    phase = random.uniform(0.0, 2.0 * np.pi, len(WHITE))
    total += hum * np.sin(2.0 * np.pi * 50.0 * np.arange(ticks)[:, None] * 1e-3 + phase)
    for _ in range(random.integers(0, 3)):
        at, channel_row = int(random.integers(ticks)), int(random.integers(len(WHITE)))
        total[at : at + int(random.integers(1, 4)), channel_row] += 12.0 * WHITE[channel_row]
    return total


def _coloured(random: np.random.Generator, ticks: int, corner_hz: float) -> np.ndarray:
    """Return a first-order Gauss-Markov process of standard deviation 1."""
    keep = float(np.exp(-2.0 * np.pi * corner_hz * 1e-3))
    drive = random.standard_normal(ticks) * np.sqrt(1.0 - keep * keep)
    drive[0] = random.standard_normal()
    return np.asarray(lfilter([1.0], [1.0, -keep], drive))


def _drift(random: np.random.Generator, ticks: int) -> np.ndarray:
    """Return a slow change of temperature: a half period of a sine of unit size, from zero."""
    span = np.arange(ticks) / max(ticks - 1, 1)
    return random.standard_normal() * np.sin(0.5 * np.pi * random.uniform(0.3, 1.5) * span)
