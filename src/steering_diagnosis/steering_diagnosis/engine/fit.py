"""A model fitted to the record: nuisances and hypotheses by Gauss-Newton under coloured noise.

Maximum a posteriori with a Gaussian prior on the nuisances (standard deviation half the tolerance)
and the noise model concentrated out (Ljung: System Identification, 10.2; Seber, Wild: Nonlinear
Regression, ch. 6). The nuisances' columns stay those of the nominal model (chord method), those of
the hypotheses are renewed at every step.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field, replace

import numpy as np

from steering_diagnosis.engine.catalogue import Catalogue, Values, bounds, room_for, scales
from steering_diagnosis.engine.equations import ROUNDED, bounded, gram_of
from steering_diagnosis.engine.evaluate import Call, Evaluator, Failed
from steering_diagnosis.engine.failures import NUMERICAL, CandidateError
from steering_diagnosis.engine.noise import Noise, fit_noise, usable
from steering_diagnosis.engine.settings import Settings
from steering_diagnosis.engine.templates import Template, secants

STEP = 0.05
"""Step of the hypotheses' differences, in typical sizes."""
STEP_Z = 0.5
"""Step of the nuisances' differences, in standard deviations."""
MOVED, TRADES, RENEWED = 1.5, 0.4, 4
"""Nuisances whose columns are renewed: moved so far, or correlated so much; at most so many."""
RENEWED_AT = (2, 5, 9)
"""Steps before which the nuisances' columns are renewed; between them by Broyden's update."""
WHITE_STEPS, WHITE_RENEWED_AT = 6, (1, 3)
"""Steps under white noise at most, and the same of them: they lead further."""
SMALL = 0.5
"""Gain in twice the log-likelihood at which the iteration ends."""


@dataclass(frozen=True)
class Problem:
    """Everything that stays fixed while models are fitted to one record.

    nuisance: columns of the nuisances, (n, outputs, p). valid, training: (n, outputs) bool.
    floor: resolution of each output, see ``Settings.resolution``. frozen: parameters of hypotheses,
    by name and position, that stay where they are. common: the noise that every model is judged in;
    None: each in that which it leaves.
    """

    runs: Evaluator
    book: Catalogue
    settings: Settings
    nuisance: np.ndarray
    valid: np.ndarray
    training: np.ndarray
    floor: np.ndarray
    frozen: frozenset[tuple[str, int]] = frozenset()
    common: Noise | None = None

    def noise(self, residual: np.ndarray) -> Noise:
        """Fit the noise to a residual on the training samples."""
        s = self.settings
        rows = usable(self.valid, s.noise_order) & self.training
        density = self.runs.grid.density
        return fit_noise(residual, rows, self.floor, s.noise_order, density, self.runs.shaken)

    def weights(self) -> np.ndarray:
        """Return the weight of each whitened sample, (n, outputs)."""
        rows = usable(self.valid, self.settings.noise_order) & self.training
        return np.sqrt(rows * self.runs.grid.density)

    def residual(self, z: np.ndarray, values: Values) -> np.ndarray:
        """Return one residual with unknown samples zero."""
        return self.known(self.runs.one(self.book.call(z, values)))

    def known(self, residual: np.ndarray) -> np.ndarray:
        """Return a residual with unknown samples zero."""
        return np.where(self.valid, residual, 0.0)

    def known_columns(self, trial: Template) -> np.ndarray:
        """Return a template's columns with unknown samples zero, (n, outputs, k)."""
        return np.where(self.valid[..., None], trial.columns, 0.0)


@dataclass(frozen=True, repr=False)
class Fit:
    """A fitted model. z: nuisances [standard deviations], (p,). misfit: -2 log posterior."""

    z: np.ndarray
    values: Values
    residual: np.ndarray
    noise: Noise
    misfit: float
    columns: Mapping[str, np.ndarray] = field(default_factory=dict)

    @property
    def names(self) -> frozenset[str]:
        """The active hypotheses."""
        return frozenset(self.values)


def assess(problem: Problem, z: np.ndarray, values: Values, residual: np.ndarray) -> Fit:
    """Return the fit at given parameters, in the common noise or in its own.

    CandidateError: its misfit is no number.
    """
    noise = problem.common
    if noise is None:
        noise = problem.noise(residual)
        found = noise.misfit
    else:
        found = energy(problem, noise, residual)
    if not np.isfinite(found):
        raise CandidateError("its misfit is no number")
    return Fit(z, values, residual, noise, found + float(z @ z))


def energy(problem: Problem, noise: Noise, residual: np.ndarray) -> float:
    """Return a residual's energy in units of a noise, over the training samples."""
    return float(np.sum(whitened(problem, noise, residual) ** 2))


def whitened(problem: Problem, noise: Noise, residual: np.ndarray) -> np.ndarray:
    """Return a residual in units of a noise, (n, outputs); zero beside the training samples."""
    return np.asarray(noise.whiten(residual) * problem.weights())


def refit(
    problem: Problem,
    z: np.ndarray,
    values: Values,
    iterations: int | None = None,
    thorough: bool = False,
) -> Fit:
    """Fit nuisances and the parameters of the active hypotheses, from a starting point.

    thorough: renew the columns of all nuisances, not only of those that matter most. Raises one of
    NUMERICAL where the model cannot be replayed there.
    """
    z = held(problem.book, z, values)
    now = assess(problem, z, values, problem.residual(z, values))
    nuisance = problem.nuisance
    stale = True
    for k in range(iterations or problem.settings.iterations):
        columns = renew(problem, now)
        if stale and (values or k):
            nuisance = renew_nuisances(problem, now, columns, nuisance, thorough)
        stale = k + 1 in RENEWED_AT
        step_z, step_values, promised = gauss_newton(problem, now, columns, nuisance)
        now = Fit(now.z, now.values, now.residual, now.noise, now.misfit, columns)
        if promised < SMALL:
            break
        better = _line_search(problem, now, step_z, step_values)
        if better is None:
            break
        gained = now.misfit - better.misfit
        nuisance = _updated(problem, nuisance, columns, now, better)
        now = Fit(better.z, better.values, better.residual, better.noise, better.misfit, columns)
        if gained < SMALL:
            break
    return now


def settled(problem: Problem, z: np.ndarray, values: Values, promised: float = np.inf) -> Fit:
    """Return the fit from a start, or from where white noise leads if that is the better one.

    Far from the truth coloured noise leaves optima of its own. Under white noise of each output's
    own size slow errors keep their weight. promised: misfit that needs no second start.
    """
    direct = refit(problem, z, values)
    if direct.misfit < promised:
        return direct
    try:
        start = _white_start(problem, z, values, _own_white)
        other = refit(problem, start.z, start.values)
    except NUMERICAL:
        return direct
    return min(direct, other, key=misfit)


def nominal(problem: Problem) -> Fit:
    """Return the best fit of the nominal model, against which every cause is weighed.

    From nominal itself, and from where white noise leads: of each output's own size, and of the
    size of what changes from sample to sample. A start that cannot be replayed costs itself alone.
    """
    none = np.zeros(len(problem.book.nuisances))
    most = 2 * problem.settings.iterations
    found = refit(problem, none, {}, most)
    for noise_of in (_own_white, _fine):
        try:
            start = _white_start(problem, none, {}, noise_of)
            found = min(found, refit(problem, start.z, {}, most), key=misfit)
        except NUMERICAL:
            continue
    return found


def _own_white(problem: Problem, fit: Fit) -> Noise:
    return problem.noise(fit.residual).white


def _fine(problem: Problem, fit: Fit) -> Noise:
    rows = problem.valid & problem.training
    return problem.noise(fit.residual).fine(fit.residual, rows, problem.floor)


def _white_start(
    problem: Problem, z: np.ndarray, values: Values, noise_of: Callable[[Problem, Fit], Noise]
) -> Fit:
    """Return the point that a few steps under white noise lead to."""
    z = held(problem.book, z, values)
    now = assess(problem, z, values, problem.residual(z, values))
    nuisance = problem.nuisance
    for k in range(WHITE_STEPS):
        columns = renew(problem, now)
        white = replace(now, noise=noise_of(problem, now))
        if k in WHITE_RENEWED_AT or (values and not k):
            nuisance = renew_nuisances(problem, white, columns, nuisance, not values)
        step_z, step_values, promised = gauss_newton(problem, white, columns, nuisance)
        if promised < SMALL:
            break
        better = _line_search(problem, now, step_z, step_values, _under(problem, white.noise))
        if better is None:
            break
        nuisance = _updated(problem, nuisance, columns, now, better)
        now = better
    return now


def _under(problem: Problem, noise: Noise) -> Callable[[Fit], float]:
    """Return the measure of a fit under a given noise."""
    return lambda fit: energy(problem, noise, fit.residual) + float(fit.z @ fit.z)


def misfit(fit: Fit) -> float:
    """Return a fit's misfit, to rank by."""
    return fit.misfit


def held(book: Catalogue, z: np.ndarray, values: Values) -> np.ndarray:
    """Return nuisances with those at nominal that a hypothesis replaces."""
    z = z.copy()
    z[book.replaced(values)] = 0.0
    return z


def renew(problem: Problem, now: Fit) -> dict[str, np.ndarray]:
    """Return the columns of the active hypotheses at the present point, per typical size.

    A step that cannot be replayed is taken the other way; CandidateError where neither can.
    """
    book = problem.book

    def moved(name: str, i: int, step: float) -> Call:
        value = now.values[name].copy()
        value[i] += step
        return book.call(now.z, {**now.values, name: value})

    steps = {}
    for name, value in now.values.items():
        h = book.hypotheses[name]
        low, high = bounds(h)
        for i, size in enumerate(scales(h)):
            steps[name, i] = room_for(STEP * size, value[i], low[i], high[i]), size
    answers = problem.runs.answers([moved(*at, step) for at, (step, _) in steps.items()])
    found: dict[str, list[np.ndarray]] = {}
    for ((name, i), (step, size)), answer in zip(steps.items(), answers, strict=True):
        if isinstance(answer, Failed):
            p = book.hypotheses[name].parameters[i]
            step = room_for(-step, now.values[name][i], p.low, p.high)
            answer = problem.runs.one(moved(name, i, step))
        change = problem.known(answer) - now.residual
        found.setdefault(name, []).append(change / (step / size) if step else 0.0 * change)
    return {name: np.stack(parts, axis=-1) for name, parts in found.items()}


def renew_nuisances(
    problem: Problem,
    now: Fit,
    columns: Mapping[str, np.ndarray],
    nuisance: np.ndarray,
    thorough: bool = False,
) -> np.ndarray:
    """Return the nuisances' columns, those renewed that the hypotheses trade with, or all."""
    p = len(now.z)
    chosen = range(p) if thorough else _traded(problem, now, columns, nuisance)
    fresh = nuisance.copy()
    stepped = secants(problem.runs, problem.book, now.z, now.values, chosen, STEP_Z)
    for i, (moved, step) in stepped.items():
        fresh[..., i] = (problem.known(moved) - now.residual) / step
    return fresh


def _traded(
    problem: Problem, now: Fit, columns: Mapping[str, np.ndarray], nuisance: np.ndarray
) -> list[int]:
    """Return the nuisances that have moved far or that the hypotheses trade with."""
    moved = np.abs(now.z) > MOVED
    stacked = np.concatenate([nuisance, *columns.values()], axis=-1)
    gram, _, _ = normal_equations(problem, now, stacked)
    p = len(now.z)
    gram[np.arange(p), np.arange(p)] += 1.0
    spread = np.linalg.pinv(gram, hermitian=True)
    size = np.sqrt(np.maximum(np.diag(spread), 1e-300))
    trade = np.abs(spread[:p, p:] / size[:p, None] / size[None, p:]).max(axis=1, initial=0.0)
    urgency = np.where(moved, 1.0 + np.abs(now.z), trade)
    return [int(i) for i in np.argsort(-urgency)[:RENEWED] if urgency[i] > TRADES]


def gauss_newton(
    problem: Problem, now: Fit, columns: Mapping[str, np.ndarray], nuisance: np.ndarray
) -> tuple[np.ndarray, dict[str, np.ndarray], float]:
    """Return the bounded step in nuisances and values, and the gain in misfit it promises."""
    book, p = problem.book, len(now.z)
    names = list(now.values)
    unit = [scales(book.hypotheses[n]) for n in names]
    stacked = np.concatenate([nuisance, *(columns[n] for n in names)], axis=-1)
    gram, slope, energy = normal_equations(problem, now, stacked)
    gram[np.arange(p), np.arange(p)] += 1.0
    slope[:p] -= now.z
    energy += float(now.z @ now.z)
    low, high = book.lowest - now.z - ROUNDED, book.highest - now.z + ROUNDED
    at_nominal = book.replaced(names)
    low[at_nominal], high[at_nominal] = -1e-9, 1e-9
    for name, u in zip(names, unit, strict=True):
        least, most = bounds(book.hypotheses[name])
        fixed = fixed_sizes(problem, name, len(u))
        least[fixed] = most[fixed] = now.values[name][fixed]
        low = np.append(low, (least - now.values[name]) / u - ROUNDED)
        high = np.append(high, (most - now.values[name]) / u + ROUNDED)
    step = bounded(gram, slope, low, high)
    promised = float(2.0 * slope @ step - step @ gram @ step)
    values, at = {}, p
    for name, u in zip(names, unit, strict=True):
        values[name] = np.where(fixed_sizes(problem, name, len(u)), 0.0, step[at : at + len(u)] * u)
        at += len(u)
    return step[:p], values, promised


def fixed_sizes(problem: Problem, name: str, count: int) -> np.ndarray:
    """Return which of a hypothesis's parameters stay where they are, (count,)."""
    return np.array([(name, i) in problem.frozen for i in range(count)], bool)


def normal_equations(
    problem: Problem, now: Fit, columns: np.ndarray
) -> tuple[np.ndarray, np.ndarray, float]:
    """Return gram matrix, slope and energy of whitened columns: minimise |e + C x|^2."""
    white = now.noise.whiten(np.concatenate([columns, now.residual[..., None]], axis=-1))
    gram = gram_of(white, problem.weights() ** 2)
    return gram[:-1, :-1].copy(), -gram[:-1, -1], float(gram[-1, -1])


def _updated(
    problem: Problem,
    nuisance: np.ndarray,
    columns: Mapping[str, np.ndarray],
    old: Fit,
    new: Fit,
) -> np.ndarray:
    """Return the nuisances' columns after a step, by Broyden's update (Broyden 1965)."""
    step = new.z - old.z
    error = new.residual - old.residual - nuisance @ step
    length = float(step @ step)
    for name, column in columns.items():
        move = (new.values[name] - old.values[name]) / scales(problem.book.hypotheses[name])
        error = error - column @ move
        length += float(move @ move)
    return nuisance + error[..., None] * (step / max(length, 1e-12))


def _line_search(
    problem: Problem,
    now: Fit,
    step_z: np.ndarray,
    step_values: Mapping[str, np.ndarray],
    measure: Callable[[Fit], float] = misfit,
) -> Fit | None:
    """Return the first of shortened steps that improves a measure, None where none does."""
    book, present = problem.book, measure(now)
    for share in (1.0, 0.4, 0.1):
        z = book.inside(now.z + share * step_z)
        values = {
            n: np.clip(v + share * step_values[n], *bounds(book.hypotheses[n]))
            for n, v in now.values.items()
        }
        try:
            trial = assess(problem, z, values, problem.residual(z, values))
        except NUMERICAL:
            continue
        if measure(trial) < present:
            return trial
    return None
