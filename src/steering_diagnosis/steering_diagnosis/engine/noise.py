"""Coloured noise of each output: an autoregression, its likelihood, and whitening.

The autoregression is fitted by least squares to what a model leaves, so that its likelihood counts
independent samples (Box, Jenkins: Time Series Analysis, ch. 7; Ljung: System Identification, 7.2).
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from steering_diagnosis.engine.kernels.whitening import whiten

WHITE_SHARE = 0.05
"""Of a residual's energy that is always taken as white. It bounds what whitening takes out of slow
errors: a constant offset would else be noise with a root near one, and explain itself away."""

INPUTS_NOISE = 4.0
"""Energy that the inputs' noise may have in an output over that of another, white draw of it."""


@dataclass(frozen=True)
class Noise:
    """Whitening filters: e_t = (r_t - sum_k a_k r_{t-k}) / sd.

    coefficients: (outputs, order). sd: innovations, (outputs,). count: independent samples judged.
    rms: of the residual itself.
    """

    coefficients: np.ndarray
    sd: np.ndarray
    count: np.ndarray
    rms: np.ndarray

    @property
    def order(self) -> int:
        """Length of the filters."""
        return self.coefficients.shape[1]

    @property
    def white(self) -> Noise:
        """The same energy without colour: the first idea that trusts slow errors most."""
        return Noise(0.0 * self.coefficients, np.maximum(self.rms, self.sd), self.count, self.rms)

    def fine(self, residual: np.ndarray, rows: np.ndarray, floor: np.ndarray) -> Noise:
        """White noise as strong as what changes from sample to sample: slow errors are none of it.

        residual, rows: (n, outputs); floor: least standard deviation, (outputs,).
        """
        kept = rows[2:] & rows[1:-1] & rows[:-2]
        bends = np.where(kept, np.diff(residual, 2, axis=0) ** 2, 0.0)
        sd = np.sqrt(bends.sum(axis=0) / (6.0 * np.maximum(kept.sum(axis=0), 1)))
        return replace(self, coefficients=0.0 * self.coefficients, sd=np.maximum(sd, floor))

    @property
    def misfit(self) -> float:
        """Minus twice the concentrated log-likelihood, up to a constant of the record."""
        return float(np.sum(self.count * np.log(self.sd**2)))

    def whiten(self, values: np.ndarray) -> np.ndarray:
        """Return (n, outputs, ...) whitened; the first ``order`` rows are zero."""
        flat = np.ascontiguousarray(values, float).reshape(*values.shape[:2], -1)
        white = np.zeros_like(flat)
        whiten(flat, self.coefficients, self.sd, white)
        return white.reshape(values.shape)


def mean_square(residual: np.ndarray, rows: np.ndarray) -> np.ndarray:
    """Return the mean square of each output on the rows, (outputs,)."""
    return np.where(rows, residual**2, 0.0).sum(axis=0) / np.maximum(rows.sum(axis=0), 1)


def usable(valid: np.ndarray, order: int) -> np.ndarray:
    """Return the rows whose whole filter length is valid, (n, outputs)."""
    rows = valid.copy()
    rows[:order] = False
    for k in range(1, order + 1):
        rows[k:] &= valid[:-k]
    return rows


def fit_noise(
    residual: np.ndarray,
    rows: np.ndarray,
    floor: np.ndarray,
    order: int,
    density: float,
    shaken: np.ndarray | None = None,
) -> Noise:
    """Fit the autoregressions.

    residual: (n, outputs), zero where unknown. rows: samples to fit, see ``usable``. floor:
    standard deviation of a white part always assumed, (outputs,): shrinks the filters.
    density: independent samples per sample. shaken: noise, (n, outputs), of which as much is always
    assumed, in its own colour.
    """
    outputs = residual.shape[1]
    coefficients = np.zeros((outputs, order))
    sd, count, rms = np.ones(outputs), np.zeros(outputs), np.zeros(outputs)
    for j in range(outputs):
        index = np.flatnonzero(rows[:, j])
        if len(index) <= 4 * order:
            continue
        lags = residual[index[:, None] - np.arange(order + 1), j]
        moments = lags.T @ lags / len(index)
        if shaken is not None:
            known = shaken[index[:, None] - np.arange(order + 1), j]
            moments += known.T @ known / len(index)
        white = max(floor[j] ** 2, WHITE_SHARE * moments[0, 0])
        moments += white * np.eye(order + 1)
        a = np.linalg.solve(moments[1:, 1:], moments[1:, 0])
        coefficients[j] = a
        sd[j] = np.sqrt(max(moments[0, 0] - a @ moments[1:, 0], 0.5 * white))
        count[j] = density * len(index)
        rms[j] = np.sqrt(moments[0, 0])
    return Noise(coefficients, sd, count, rms)
