"""Families of frequency responses from low to high torque, and their margins."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

TORQUES = (0.0, 1.0, 2.0, 3.0, 4.0)
"""Torsion-bar torques [N m] of the families, low to high."""


def grid(lowest: float = 0.1, highest: float = 1000.0, count: int = 400) -> np.ndarray:
    """Return frequencies [Hz], even in the logarithm."""
    return np.logspace(np.log10(lowest), np.log10(highest), count)


@dataclass(frozen=True)
class Margins:
    """Stability margins of a loop gain: gain margin as a factor (inf: none), phase margin [deg].

    Frequencies [Hz] where they are read, nan where there is no crossing.
    """

    gain: float
    phase: float
    gain_frequency: float
    crossover: float

    def numbers(self) -> dict[str, float | None]:
        """Return the margins for JSON, the gain margin in dB as well."""
        decibel = 20.0 * np.log10(self.gain) if np.isfinite(self.gain) else np.inf
        values = {
            "gain_margin": self.gain,
            "gain_margin_dB": decibel,
            "phase_margin_deg": self.phase,
            "gain_margin_Hz": self.gain_frequency,
            "crossover_Hz": self.crossover,
        }
        return {name: float(v) if np.isfinite(v) else None for name, v in values.items()}


def margins(frequency: np.ndarray, loop: np.ndarray) -> Margins:
    """Return the margins of a loop gain (n,) over frequency [Hz] through python-control."""
    import control

    data = control.FrequencyResponseData(loop, 2.0 * np.pi * frequency, smooth=True)
    gain, phase, _, w_180, w_c, _ = control.stability_margins(data)
    hertz = 0.5 / np.pi
    return Margins(float(gain), float(phase), float(w_180) * hertz, float(w_c) * hertz)


@dataclass(frozen=True)
class Family:
    """Frequency responses (m, n), complex, at ``frequency`` [Hz] (n,) for ``torque`` [N m] (m,).

    figure: number of the source's figure. is_loop: a loop gain, which has margins.
    """

    figure: str
    title: str
    frequency: np.ndarray
    torque: np.ndarray
    response: np.ndarray
    is_loop: bool = False

    @property
    def decibel(self) -> np.ndarray:
        """Amplitudes [dB], (m, n)."""
        return 20.0 * np.log10(np.abs(self.response))

    @property
    def degrees(self) -> np.ndarray:
        """Phases [deg], continuous over frequency, (m, n)."""
        return np.degrees(np.unwrap(np.angle(self.response), axis=1))

    def margins(self) -> list[Margins]:
        """Return the margins at each torque."""
        return [margins(self.frequency, loop) for loop in self.response]

    def at(self, frequency: float) -> tuple[np.ndarray, np.ndarray]:
        """Return amplitudes [dB] and phases [deg] of all torques at a frequency [Hz]."""
        where = int(np.argmin(np.abs(np.log(self.frequency / frequency))))
        return self.decibel[:, where], self.degrees[:, where]

    def corner(self, degrees: float = -45.0) -> np.ndarray:
        """Return where each phase first falls below ``degrees`` [Hz], nan where it never does."""
        below = self.degrees < degrees
        first = np.where(below.any(axis=1), below.argmax(axis=1), len(self.frequency) - 1)
        return np.where(below.any(axis=1), self.frequency[first], np.nan)

    def numbers(self) -> dict[str, Any]:
        """Return the figures of merit for JSON, one entry a torque."""
        low, high = self.decibel[:, 0], self.decibel.max(axis=1)
        rows: list[dict[str, Any]] = []
        loops = self.margins() if self.is_loop else [None] * len(self.torque)
        for k, (torque, loop) in enumerate(zip(self.torque, loops, strict=True)):
            row = {
                "torque_Nm": float(torque),
                "low_frequency_dB": float(low[k]),
                "largest_dB": float(high[k]),
                "lag_45_deg_Hz": _finite(self.corner()[k]),
            }
            rows.append(row | (loop.numbers() if loop else {}))
        return {"figure": self.figure, "title": self.title, "curves": rows}


def family(
    figure: str,
    title: str,
    response: Callable[[float, np.ndarray], np.ndarray],
    *,
    torques: Sequence[float] = TORQUES,
    frequency: np.ndarray | None = None,
    is_loop: bool = False,
) -> Family:
    """Return the family of ``response(torque, omega)`` over torques [N m]."""
    hertz = grid() if frequency is None else frequency
    rows = [response(torque, 2.0 * np.pi * hertz) for torque in torques]
    return Family(figure, title, hertz, np.array(torques, float), np.array(rows), is_loop)


def _finite(value: float) -> float | None:
    return float(value) if np.isfinite(value) else None
