"""A pump's ripple: a line in the spectrum of the supply pressure, often far above all else.

The engine judges a band that ends below most pumps' ripple, so a line is looked for beforehand.
Where there is one, the supply pressure's residual is shifted down by its frequency and becomes two
more outputs; the hypothesis begins at the line. Where there is none, there is no ripple to name.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from scipy import signal

from steering_diagnosis.data.channels import CHANNELS
from steering_diagnosis.data.record import PERIOD_S
from steering_diagnosis.engine.model import Hypothesis, Output
from steering_diagnosis.steering.drive import Drive
from steering_diagnosis.steering.outputs import Predicted, Run
from steering_diagnosis.steering.simulation import as_measured
from steering_diagnosis.steering.smoothing import bridged

EFFECT = "pump_flow_ripple"
CHANNEL = "supply_pressure"
LOWEST_HZ, HIGHEST_HZ = 25.0, 450.0
"""Where a line is looked for: above the driver's motion, below half the sampling rate."""

PROMINENCE = 40.0
"""Power of the line over the median around it; noise reaches 20 to 25 among ten thousand bins."""

SEEN_DIRECTLY_HZ = 60.0
"""Below it the engine's own band has the line."""

TRIAL = 0.02
"""Amplitude that the line's own is found by comparison with."""

TURN = 2.0 * np.pi
"""Phases [rad] that differ by it are the same."""

NARROW = 3.0
"""Resolutions of the record that the frequency may differ from the line."""


@dataclass(frozen=True)
class Line:
    """A spectral line. width_hz: resolution of the record's length."""

    hz: float
    width_hz: float


def find_line(residual: np.ndarray) -> Line | None:
    """Return the clearest line in a residual (n,), or None where nothing stands out.

    Where that is the second harmonic of a stronger line, it is the stronger one: the background
    falls with frequency, so that a harmonic may stand out more.
    """
    n = len(residual)
    power = np.abs(np.fft.rfft(residual * signal.windows.hann(n, False))) ** 2
    hz = np.fft.rfftfreq(n, PERIOD_S)
    around = 2 * max(10, n // 400) + 1
    inside = np.flatnonzero((hz > LOWEST_HZ) & (hz < HIGHEST_HZ))
    if len(inside) < 2 * around:
        return None
    background = np.full(len(power), np.inf)
    windows = np.lib.stride_tricks.sliding_window_view(power, around)
    background[around // 2 : len(power) - around // 2] = np.median(windows, axis=1)
    peak = int(inside[np.argmax(power[inside] / background[inside])])
    if power[peak] < PROMINENCE * background[peak]:
        return None
    peak = _fundamental(power, background, peak, int(inside[0]))
    below, top, above = np.log(power[peak - 1 : peak + 2])
    shift = 0.5 * (below - above) / (below - 2.0 * top + above)
    return Line(float(hz[peak] + shift * hz[1]), float(hz[1]))


def _fundamental(power: np.ndarray, background: np.ndarray, peak: int, lowest: int) -> int:
    """Return the line at half the frequency, where that one has more power, else ``peak``."""
    around = np.arange(peak // 2 - 1, peak // 2 + 3)
    half = int(around[np.argmax(power[around])])
    stands_out = power[half] > max(PROMINENCE * background[half], power[peak])
    return half if half >= lowest and stands_out else peak


def shifted(line: Line) -> tuple[Predicted, ...]:
    """Return the outputs that hold the supply pressure's residual about a line."""
    if line.hz < SEEN_DIRECTLY_HZ:
        return ()

    def about(quarter: float) -> Predicted:
        def residual(run: Run) -> np.ndarray:
            error = supply_error(run)
            turns = line.hz * PERIOD_S * np.arange(len(error)) - quarter
            return 2.0 * error * np.cos(2.0 * np.pi * turns)

        name = f"{CHANNEL}_at_{line.hz:.0f}_hz_{'sine' if quarter else 'cosine'}"
        return Predicted(Output(name, CHANNELS[CHANNEL].unit, "supply"), _there, residual)

    return about(0.0), about(0.25)


def supply_error(run: Run) -> np.ndarray:
    """Return measured less predicted supply pressure [Pa], (n,), gaps bridged."""
    predicted = as_measured(run.trace.supply, run.parameters, CHANNEL)
    return bridged(run.drive.record[CHANNEL]) - predicted


def estimate(
    line: Line, error: np.ndarray, answer: Callable[[float, float], np.ndarray]
) -> tuple[float, float]:
    """Return amplitude and phase [rad] of the flow's ripple that explains a line in ``error``.

    answer: error (n,) with the effect's amplitude and frequency [Hz], at no phase.
    """
    turning = np.exp(-2j * np.pi * line.hz * PERIOD_S * np.arange(len(error)))
    there = np.mean(error * turning)
    made = there - np.mean(answer(TRIAL, line.hz) * turning)
    ripple = TRIAL * there / made
    return float(np.clip(abs(ripple), 1e-3, 0.3)), float(np.angle(ripple))


def _there(drive: Drive) -> bool:
    return CHANNEL in drive.record


def at_line(hypothesis: Hypothesis, line: Line, amplitude: float, phase: float) -> Hypothesis:
    """Return the hypothesis of ripple with its line's values as typical ones.

    Within the effect's bounds, but for the phase, which may go on through a turn's end.
    """
    reach = NARROW * line.width_hz
    known = {p.name: p for p in hypothesis.parameters}["frequency"]
    low, high = max(known.low, line.hz - reach), min(known.high, line.hz + reach)
    values: dict[str, dict[str, Any]] = {
        "amplitude": {"typical": amplitude},
        "frequency": {"typical": line.hz, "low": low, "high": high},
        "phase": {"typical": phase, "low": phase - np.pi, "high": phase + np.pi, "turn": TURN},
    }
    return replace(
        hypothesis,
        parameters=tuple(replace(p, **values.get(p.name, {})) for p in hypothesis.parameters),
    )
