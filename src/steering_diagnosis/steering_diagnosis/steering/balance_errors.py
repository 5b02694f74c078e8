"""How much error enters at each balance, how far above the noise, and where."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace

import numpy as np
from scipy import signal

from steering_diagnosis.data.channels import MEASURED
from steering_diagnosis.data.record import PERIOD_S, Record
from steering_diagnosis.engine.model import Effects
from steering_diagnosis.report import BalanceError
from steering_diagnosis.steering.balances import BALANCES
from steering_diagnosis.steering.clamped import POSITION, clamp
from steering_diagnosis.steering.drive import RUN_UP, Drive
from steering_diagnosis.steering.replay import SteeringReplay
from steering_diagnosis.steering.smoothing import low_pass

LOWEST_HZ, HIGHEST_HZ = 20.0, 60.0
"""Bounds of the common low-pass."""

MOVING, RESTING = 1e-3, 1e-5
"""Noise is taken to be at least these shares of how the balance's terms move, and of their size."""

BINS = 24


class Balances:
    """The balances of one record."""

    def __init__(self, replay: SteeringReplay) -> None:
        self.replay = replay
        record = replay.record
        known = set(record.channels)
        self.cutoff_hz = _common_cutoff(replay.drive)
        self.present = tuple(
            b
            for b in BALANCES
            if record.valve_system in b.systems
            and set(b.needs) <= known
            and (replay.drive.valves or "chamber" not in b.name)
            and (b.name != "tyre" or record.vehicle_load == "bicycle")
        )
        self._judged = replay.judged

    def residuals(
        self, nuisances: Mapping[str, float], effects: Effects, record: Record | None = None
    ) -> dict[str, np.ndarray]:
        """Return the residual of each balance in its unit, by name, (n,)."""
        clamped = clamp(record or self.replay.record, self.cutoff_hz, nuisances, effects)
        return {b.name: low_pass(b.residual(clamped), self.cutoff_hz) for b in self.present}

    def noise(self) -> dict[str, float]:
        """Return the standard deviation that the sensors' noise alone gives each balance.

        Noise as each channel has it is added once more, and what changes is the answer.
        """
        record, spectra = self.replay.record, self.replay.drive.curves
        draws = np.random.default_rng(0)
        channels = dict(record.channels)
        for name in MEASURED:
            if name in spectra:
                noise = spectra[name].spectrum.noise
                channels[name] = record[name] + noise * draws.standard_normal(len(record))
        plain = self.residuals({}, {})
        more = self.residuals({}, {}, replace(record, channels=channels))
        terms = clamp(record, self.cutoff_hz, {}, {})
        found = {}
        for b in self.present:
            added = np.std((more[b.name] - plain[b.name])[self._judged])
            size = b.scale(terms)[self._judged]
            found[b.name] = float(np.hypot(added, MOVING * np.std(size) + RESTING * _rms(size)))
        return found

    def errors(
        self,
        nuisances: Mapping[str, float],
        effects: Effects,
        refitted: Mapping[str, float] | None = None,
    ) -> tuple[BalanceError, ...]:
        """Return the evidence of all balances: nominal, and with ``nuisances`` and ``effects``.

        refitted: nuisances without any effect, to begin with; None: the data sheet's.
        """
        nominal = self.residuals(refitted or {}, {})
        extended = self.residuals(nuisances, effects)
        noise = self.noise()
        above = {n: _rms(e[self._judged]) / noise[n] for n, e in nominal.items()}
        energy = {n: max(a * a - 1.0, 0.0) for n, a in above.items()}
        total = sum(energy.values()) or 1.0
        axes = self._axes()
        return tuple(
            BalanceError(
                balance=b.name,
                unit=b.unit,
                share=energy[b.name] / total,
                above_noise=above[b.name],
                residual=nominal[b.name],
                extended=extended[b.name],
                by=self._by(nominal[b.name], axes),
            )
            for b in self.present
        )

    def _axes(self) -> dict[str, np.ndarray]:
        curves = self.replay.drive.curves
        states_ = self.replay.states()
        position = states_["rack position [m]"]
        if POSITION in curves:
            position = curves[POSITION].values[RUN_UP:]
        return {
            "time": self.replay.record.time,
            "speed": np.gradient(position, PERIOD_S),
            "pressure": states_["load pressure [Pa]"],
            "position": position,
        }

    def _by(
        self, residual: np.ndarray, axes: Mapping[str, np.ndarray]
    ) -> dict[str, tuple[np.ndarray, np.ndarray]]:
        judged = self._judged
        found = {name: binned(axis[judged], residual[judged]) for name, axis in axes.items()}
        found["frequency"] = by_frequency(np.where(judged, residual, 0.0), self.cutoff_hz)
        return found


def _common_cutoff(drive: Drive) -> float:
    cutoffs = [c.cutoff_hz for c in drive.curves.values() if c.smoothed]
    wanted = float(np.quantile(cutoffs, 0.75)) if cutoffs else HIGHEST_HZ
    return min(max(wanted, LOWEST_HZ), HIGHEST_HZ)


def binned(axis: np.ndarray, residual: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return bin centres along ``axis`` and the residual's root mean square in each."""
    edges = np.linspace(axis.min(), axis.max() + 1e-12, BINS + 1)
    bins = np.clip(np.digitize(axis, edges) - 1, 0, BINS - 1)
    counts = np.bincount(bins, minlength=BINS)
    sums = np.bincount(bins, residual * residual, BINS)
    centres = 0.5 * (edges[:-1] + edges[1:])
    full = counts > 0
    return centres[full], np.sqrt(sums[full] / counts[full])


def by_frequency(residual: np.ndarray, highest_hz: float) -> tuple[np.ndarray, np.ndarray]:
    """Return third-octave-like bands [Hz] and the residual's root mean square in each."""
    hz, density = signal.welch(residual, 1.0 / PERIOD_S, nperseg=min(4096, len(residual)))
    edges = np.geomspace(max(hz[1], 0.2), 1.5 * highest_hz, BINS + 1)
    bands = np.digitize(hz, edges) - 1
    power = [float(density[bands == k].sum() * hz[1]) for k in range(BINS)]
    there = np.array([np.any(bands == k) for k in range(BINS)])
    centres = np.sqrt(edges[:-1] * edges[1:])
    return centres[there], np.sqrt(np.array(power)[there])


def _rms(values: np.ndarray) -> float:
    return float(np.sqrt(np.mean(values * values)))
