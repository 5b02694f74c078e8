"""Is a cause real? Family-wise likelihood ratio, information criterion and held-out gain."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy import stats

from steering_diagnosis.engine.catalogue import scales
from steering_diagnosis.engine.evaluate import Evaluator
from steering_diagnosis.engine.fit import Fit, Problem, energy, whitened
from steering_diagnosis.engine.intervals import covariance
from steering_diagnosis.engine.noise import INPUTS_NOISE, Noise, fit_noise, mean_square, usable
from steering_diagnosis.engine.sampling import blocks
from steering_diagnosis.engine.settings import Settings

SURE = 2.0
"""Standard errors between an estimate and what would be no cause."""
STRONG = 10.0
"""Difference of the information criterion that counts as strong (Kass, Raftery 1995)."""


@dataclass(frozen=True)
class HeldOut:
    """Samples that took no part in the fit: blocks of the record, or another record.

    runs: None where the blocks are the fitted record's own. valid, rows: (n, outputs); block: (n,).
    moment: number of the short time that a sample belongs to, (n,), see ``Settings.moment_s``.
    """

    runs: Evaluator | None
    valid: np.ndarray
    block: np.ndarray
    rows: np.ndarray
    moment: np.ndarray

    def residual(self, problem: Problem, fit: Fit) -> np.ndarray:
        """Return the residual of a fit on the held-out record, unknown samples zero."""
        if self.runs is None:
            return fit.residual
        raw = self.runs.one(problem.book.call(fit.z, fit.values))
        return np.where(self.valid, raw, 0.0)

    def gain(
        self, problem: Problem, old: Noise, new: Noise, before: np.ndarray, after: np.ndarray
    ) -> np.ndarray:
        """Return the gain in twice the predictive log-likelihood of each output in each moment.

        Shape (known outputs of all moments,). Outputs have noise of their own: an event that
        several of them feel speaks for a cause although it lasts a moment only. Another record has
        noise of its own too, that of what the better model leaves there.
        """
        if self.runs is not None:
            rows = usable(self.valid, new.order) & self.rows
            density = self.runs.grid.density
            old = new = fit_noise(after, rows, problem.floor, new.order, density)
        return self.scores(old, before) - self.scores(new, after)

    def scores(self, noise: Noise, residual: np.ndarray) -> np.ndarray:
        """Return minus twice the predictive log-likelihood of each output in each moment."""
        rows = usable(self.valid, noise.order) & self.rows
        each = np.where(rows, noise.whiten(residual) ** 2 + np.log(noise.sd**2), 0.0)
        columns = range(rows.shape[1])
        summed = np.array([np.bincount(self.moment, each[:, i]) for i in columns])
        return summed[np.array([np.bincount(self.moment, rows[:, i]) for i in columns]) > 0]

    def energy(self, residual: np.ndarray) -> np.ndarray:
        """Return the mean square of each output on the held-out samples, (outputs,)."""
        return mean_square(residual, self.rows & self.valid)


ALIKE = 0.98
"""A nuisance expresses a hypothesis from this cosine of their whitened traces."""


@dataclass(frozen=True)
class Evidence:
    """What speaks for a cause.

    ratio: twice the log-likelihood ratio, without what is gained by handing on less of the inputs'
    noise. gains: of each output, that included, (outputs,). p_value: family-wise. delta_bic:
    negative speaks for it. sigmas: held-out gain over its standard error. share: of the error
    energy above the noise that the present model leaves; material: the same of the best single
    output. why_not: empty if real.
    """

    ratio: float
    gains: np.ndarray
    p_value: float
    delta_bic: float
    sigmas: float
    share: float
    material: float
    why_not: str


def family_p(ratio: float, parameters: int, trials: int, inflation: float) -> float:
    """Return the family-wise p-value of a likelihood ratio."""
    single = stats.chi2.sf(max(ratio, 0.0) / inflation, parameters)
    return float(-np.expm1(trials * np.log1p(-min(single, 1.0 - 1e-16))))


def critical_ratio(settings: Settings, trials: int) -> float:
    """Return the ratio of one parameter that is significant over the catalogue."""
    return float(stats.chi2.isf(settings.family_p / max(trials, 1), 1) * settings.inflation)


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
    quieter = handed_on(problem, without) - handed_on(problem, full)
    ratio = without.misfit - full.misfit - max(quieter, 0.0)
    p = family_p(ratio, max(k, 1), trials, s.inflation)
    bic = -ratio + max(k, 1) * np.log(max(full.noise.count.max(), 2.0))
    before, after = held.residual(problem, without), held.residual(problem, full)
    gain = held.gain(problem, without.noise, full.noise, before, after)
    sigmas = certainty(gain)
    share, material = shares(held.energy(before), held.energy(after), floor)
    (cause,) = full.names - without.names
    beyond, size = size_of(problem, full, cause)
    first = not without.values
    least = s.least_share if first else s.least_share_next
    if problem.book.nuisance_of(cause) is not None:
        least = max(least, s.least_share_parameter)
    samples = max(float(full.noise.count.max()), 1.0)
    reasons = [
        (p > s.family_p, f"not significant over the catalogue (p = {p:.2g})"),
        (ratio < s.least_gain_of(cause) * samples, f"gains only {ratio / samples:.2f} a sample"),
        (bic > -STRONG, f"the information criterion is against it ({bic:+.1f})"),
        (sigmas < s.held_out_sigmas, f"no certain gain on held-out data ({sigmas:.1f} sigma)"),
        (material < least, f"removes only {material:.0%} of the error above the noise"),
        (size < s.least_size, f"too small to be seen ({size:.0%} of a visible size)"),
        (not beyond, "its interval reaches into what the tolerances allow"),
        (at_bound(problem, full, cause), "its estimate runs to the end of its bounds"),
    ]
    why = next((text for failed, text in reasons if failed), "")
    parts = [whitened(problem, full.noise, fit.residual) ** 2 for fit in (without, full)]
    gains = parts[0].sum(axis=0) - parts[1].sum(axis=0)
    return Evidence(ratio, gains, p, float(bic), sigmas, share, material, why)


def handed_on(problem: Problem, fit: Fit) -> float:
    """Return the energy that the inputs' noise may have in a model, in units of the noise.

    A model that hands on less fits better by that, whether it is right or not: with a force sensor
    that reads too much, a load cell's noise shakes the rack less.
    """
    shaken = problem.known(problem.runs.shaken_in(problem.book.call(fit.z, fit.values)))
    return INPUTS_NOISE * energy(problem, fit.noise, shaken)


def size_of(problem: Problem, full: Fit, cause: str) -> tuple[bool, float]:
    """Return whether a cause's interval is beyond neutral and tolerance, and its visible size.

    Where a nuisance expresses the same, the size is counted in what that nuisance would need.
    """
    h = problem.book.hypotheses[cause]
    unit = (full.values[cause] - [p.neutral for p in h.parameters]) / scales(h)
    amplitudes = [i for i, p in enumerate(h.parameters) if not p.shape] or range(len(unit))
    k = max(amplitudes, key=lambda i: abs(unit[i]))
    grid = problem.runs.grid
    spread = covariance(problem, full, blocks(len(full.residual), grid.step_s, problem.settings))
    at = problem.nuisance.shape[-1]
    for name, value in full.values.items():
        if name == cause:
            break
        at += len(value)
    sd, _ = spread.deviation(at + k)
    tolerated = _tolerated(problem, full, cause, k)
    # A nuisance that the cause replaces stays nominal, but is not known to be so.
    replaced = 0.5 * sum(tolerated.get(name, 0.0) for name in h.replaces)
    least = max(abs(unit[k]) - SURE * float(np.hypot(sd, replaced)), 0.0)
    return least > sum(tolerated.values()), float(abs(unit[k]))


def at_bound(problem: Problem, full: Fit, cause: str) -> bool:
    """Return whether a parameter of a cause, shapes aside, stands at its bound."""
    for p, value in zip(problem.book.hypotheses[cause].parameters, full.values[cause], strict=True):
        margin = 5e-3 * (p.high - p.low)
        away = abs(value - p.neutral) > margin
        if not p.shape and away and not p.low + margin < value < p.high - margin:
            return True
    return False


def _tolerated(problem: Problem, full: Fit, cause: str, k: int) -> dict[str, float]:
    """Return the size [typical sizes] that each competing nuisance expresses within tolerance."""
    h = problem.book.hypotheses[cause]
    weights = problem.weights()
    column = (full.noise.whiten(full.columns[cause][..., k]) * weights).ravel()
    found = {}
    for name in h.competes:
        if name in problem.book.index and column @ column > 0.0:
            whole = problem.nuisance[..., problem.book.index[name]]
            one = (full.noise.whiten(whole) * weights).ravel()
            alike = abs(float(one @ column)) / float(np.linalg.norm(one) * np.linalg.norm(column))
            if alike > ALIKE:
                found[name] = 2.0 * abs(float(one @ column) / float(column @ column))
    return found


def certainty(gain: np.ndarray) -> float:
    """Return the mean gain of blocks or moments over its standard error, (blocks,).

    Of signed square roots: few with much excitation may hold most of the gain. Where k of them hold
    it all, it is the root of k.
    """
    root = np.sign(gain) * np.sqrt(np.abs(gain))
    if gain.sum() <= 0.0:
        return min(0.0, float(root.sum()))
    return float(root.sum() / (np.sqrt(len(root)) * root.std(ddof=1) + 1e-12))


def shares(before: np.ndarray, after: np.ndarray, floor: np.ndarray) -> tuple[float, float]:
    """Return the share of the error energy above the floor that is gone, overall and at best.

    Outputs whose error is not above the floor by a quarter do not count for the best.
    """
    least = np.minimum(floor, after)
    unit = np.maximum(least, 1e-300)
    above = np.maximum(before - least, 0.0) / unit
    gone = (before - after) / unit
    if above.sum() <= 0.0:
        return 0.0, 0.0
    overall = float(gone.sum() / above.sum())
    clear = above > 0.25
    best = float((gone[clear] / above[clear]).max()) if clear.any() else overall
    return overall, max(best, overall)
