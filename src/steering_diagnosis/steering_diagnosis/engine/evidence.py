"""Is a cause real? Family-wise likelihood ratio, information criterion and held-out gain."""

from __future__ import annotations

import json
from dataclasses import dataclass
from functools import cache
from importlib import resources
from typing import Any

import numpy as np
from scipy import stats

from steering_diagnosis.engine.evaluate import Evaluator
from steering_diagnosis.engine.fit import Fit, Problem
from steering_diagnosis.engine.noise import Noise, usable

STRONG = 10.0
"""Difference of the information criterion that counts as strong (Kass, Raftery 1995)."""


@dataclass(frozen=True)
class HeldOut:
    """Samples that took no part in the fit: blocks of the record, or another record.

    runs: None where the blocks are the fitted record's own. valid, rows: (n, outputs); block: (n,).
    """

    runs: Evaluator | None
    valid: np.ndarray
    block: np.ndarray
    rows: np.ndarray

    def residual(self, problem: Problem, fit: Fit) -> np.ndarray:
        """Return the residual of a fit on the held-out record, unknown samples zero."""
        if self.runs is None:
            return fit.residual
        raw = self.runs.one(problem.book.call(fit.z, fit.values))
        return np.where(self.valid, raw, 0.0)

    def scores(self, noise: Noise, residual: np.ndarray) -> np.ndarray:
        """Return minus twice the predictive log-likelihood of each block, (blocks,)."""
        rows = usable(self.valid, noise.order) & self.rows
        white = noise.whiten(residual)
        each = np.where(rows, white**2 + np.log(noise.sd**2), 0.0).sum(axis=1)
        return np.bincount(self.block, each)[np.bincount(self.block, rows.any(axis=1)) > 0]

    def energy(self, residual: np.ndarray) -> np.ndarray:
        """Return the mean square of each output on the held-out samples, (outputs,)."""
        rows = self.rows & self.valid
        return np.where(rows, residual**2, 0.0).sum(axis=0) / np.maximum(rows.sum(axis=0), 1)


@dataclass(frozen=True)
class Evidence:
    """What speaks for a cause.

    ratio: twice the log-likelihood ratio. p_value: family-wise. delta_bic: negative speaks for it.
    sigmas: held-out gain over its standard error. share: of the error energy above the noise that
    the present model leaves; material: the same of the best single output. why_not: empty if real.
    """

    ratio: float
    p_value: float
    delta_bic: float
    sigmas: float
    share: float
    material: float
    why_not: str


@cache
def calibration() -> dict[str, Any]:
    """Return the family-wise calibration on clean records (``calibrate.py`` makes it)."""
    text = resources.files("steering_diagnosis.engine").joinpath("calibration.json").read_text()
    return dict(json.loads(text))


def family_p(ratio: float, parameters: int, trials: int) -> float:
    """Return the family-wise p-value of a likelihood ratio, calibrated on clean records."""
    inflation = float(calibration()["inflation"])
    single = stats.chi2.sf(max(ratio, 0.0) / inflation, parameters)
    return float(-np.expm1(trials * np.log1p(-min(single, 1.0 - 1e-16))))


def weigh(
    problem: Problem,
    held: HeldOut,
    without: Fit,
    full: Fit,
    floor: np.ndarray,
    trials: int,
) -> Evidence:
    """Weigh a model with one more cause against the model without it.

    floor: mean squares that the whole catalogue set free would leave, (outputs,).
    """
    s = problem.settings
    k = sum(len(v) for v in full.values.values()) - sum(len(v) for v in without.values.values())
    ratio = without.misfit - full.misfit
    p = family_p(ratio, max(k, 1), trials)
    bic = -ratio + max(k, 1) * np.log(max(full.noise.count.max(), 2.0))
    before, after = held.residual(problem, without), held.residual(problem, full)
    gain = held.scores(without.noise, before) - held.scores(full.noise, after)
    sigmas = float(gain.sum() / (np.sqrt(len(gain)) * gain.std(ddof=1) + 1e-12))
    share, material = shares(held.energy(before), held.energy(after), floor)
    first = not without.values
    least = s.least_share if first else s.least_share_next
    reasons = [
        (p > s.family_p, f"not significant over the catalogue (p = {p:.2g})"),
        (bic > -STRONG, f"the information criterion is against it ({bic:+.1f})"),
        (sigmas < s.held_out_sigmas, f"no certain gain on held-out data ({sigmas:.1f} sigma)"),
        (material < least, f"removes only {material:.0%} of the error above the noise"),
    ]
    why = next((text for failed, text in reasons if failed), "")
    return Evidence(ratio, p, float(bic), sigmas, share, material, why)


def shares(before: np.ndarray, after: np.ndarray, floor: np.ndarray) -> tuple[float, float]:
    """Return the share of the error energy above the floor that is gone, overall and at best.

    Outputs whose error is not above the floor by a quarter do not count for the best.
    """
    least = np.minimum(floor, after)
    unit = np.maximum(least, 1e-300)
    above = np.maximum(before - least, 0.0) / unit
    gone = (before - after) / unit
    overall = float(gone.sum() / max(above.sum(), 1e-12))
    clear = above > 0.25
    best = float((gone[clear] / above[clear]).max()) if clear.any() else overall
    return overall, max(best, overall)
