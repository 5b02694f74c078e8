"""Screening: the whole catalogue by linear algebra, before any hypothesis is refitted.

Nuisances and the causes already found are projected out of every template (score test, Rao 1948).
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from functools import partial

import numpy as np

from steering_diagnosis.engine.catalogue import FURTHEST, bounds
from steering_diagnosis.engine.equations import bounded
from steering_diagnosis.engine.failures import NUMERICAL
from steering_diagnosis.engine.fit import Fit, Problem, assess, normal_equations
from steering_diagnosis.engine.noise import mean_square
from steering_diagnosis.engine.templates import Template

PAIR_LEAD = 1.1
"""A pair has to beat the best single hypothesis by this factor."""
FIXED = 1e9
"""Prior weight of a nuisance that cannot move."""
NEAR = 0.01
"""Standard deviations within which a nuisance is at an end."""
REMOVES = 0.1
"""Share of the error, mean of the outputs, that a template of shapes alone has to remove as it is
to be refitted whatever its gain."""
WIDE = 3.0
"""In the saturated model every template is free with this prior standard deviation."""


@dataclass(frozen=True)
class Score:
    """A screened template. gain: in misfit. z, values: to refit from. removes: ``_removing``."""

    hypothesis: str
    gain: float
    z: np.ndarray
    values: dict[str, np.ndarray]
    removes: float = 0.0


def active_columns(now: Fit) -> np.ndarray:
    """Return the columns of the causes already found, (n, outputs, a)."""
    parts = [now.columns[n] for n in now.values if n in now.columns]
    return np.concatenate(parts, axis=-1) if parts else np.zeros((*now.residual.shape, 0))


def saturated(problem: Problem, now: Fit, trials: Sequence[Template]) -> np.ndarray:
    """Return the residual that the whole catalogue, set free, would leave.

    It begins under white noise, which leaves slow errors their weight.
    """
    columns = _stack(problem, now, trials)
    p = problem.nuisance.shape[-1]
    prior = np.r_[np.ones(p), np.full(columns.shape[-1] - p, WIDE**-2)]
    residual, noise = now.residual, now.noise.white
    for _ in range(3):
        state = Fit(now.z, now.values, now.residual, noise, now.misfit)
        gram, slope, _ = normal_equations(problem, state, columns)
        slope[:p] -= now.z
        x = np.linalg.solve(gram + np.diag(prior), slope)
        residual = now.residual + columns @ x
        noise = problem.noise(residual)
    return residual


Attempt = Callable[[str, Callable[[], Score]], Score | None]
"""Calls what scores a hypothesis; None where that fails, which costs this hypothesis alone."""


def screen(problem: Problem, now: Fit, trials: Sequence[Template], attempt: Attempt) -> list[Score]:
    """Return the hypotheses that may come next, best first."""
    trials = [t for t in trials if t.hypothesis not in now.values]
    if not trials:
        return []
    gains = _gains(problem, now, trials, _stack(problem, now, trials))
    best: dict[str, int] = {}
    for i in np.argsort(-gains):
        best.setdefault(trials[i].hypothesis, int(i))
    chosen = list(best.values())[: problem.settings.screened]
    begun = {trials[i].hypothesis: (trials[i], 0.0) for i in chosen}
    begun |= {t.hypothesis: (t, share) for share, t in _removing(problem, now, trials)}
    scores = [attempt(n, partial(_score, problem, now, *b)) for n, b in begun.items()]
    return sorted((s for s in scores if s), key=lambda s: (-s.gain, s.hypothesis))


def _score(problem: Problem, now: Fit, trial: Template, removes: float) -> Score:
    return replace(start_of(problem, now, trial), removes=removes)


def _removing(
    problem: Problem, now: Fit, trials: Sequence[Template]
) -> list[tuple[float, Template]]:
    """Return for each hypothesis of shapes alone what its best template removes, where it is much.

    A stop that is softer than its template is off at every contact: in coloured noise, where slow
    errors weigh little, the template gains nothing although most of the error is gone.
    """
    rows = problem.valid & problem.training
    before = np.maximum(mean_square(now.residual, rows), 1e-300)
    best: dict[str, tuple[float, Template]] = {}
    for trial in trials:
        if problem.book.hypotheses[trial.hypothesis].shapes_only:
            left = now.residual + problem.known_columns(trial)[..., 0]
            share = float(np.mean(1.0 - mean_square(left, rows) / before))
            if share > best.get(trial.hypothesis, (REMOVES, trial))[0]:
                best[trial.hypothesis] = share, trial
    return list(best.values())


def pairs(
    problem: Problem,
    now: Fit,
    trials: Sequence[Template],
    least: float,
    most: int,
) -> list[tuple[str, str]]:
    """Return pairs that together help clearly more than any single hypothesis, best first."""
    trials = [t for t in trials if t.hypothesis not in now.values]
    columns = _stack(problem, now, trials)
    gram, slope, at = _projected(problem, now, trials, columns)
    single = {i: _gain(gram, slope, at[i]) for i in range(len(trials))}
    alone = max(single.values())
    ranked: dict[tuple[str, str], float] = {}
    for i in range(len(trials)):
        for j in range(i):
            a, b = trials[i].hypothesis, trials[j].hypothesis
            if a != b:
                both = _gain(gram, slope, np.r_[at[i], at[j]])
                pair = (min(a, b), max(a, b))
                if both > max(PAIR_LEAD * alone, alone + least):
                    ranked[pair] = max(ranked.get(pair, 0.0), both)
    return sorted(ranked, key=lambda p: (-ranked[p], p))[:most]


def _stack(problem: Problem, now: Fit, trials: Sequence[Template]) -> np.ndarray:
    parts = [problem.nuisance, active_columns(now), *(problem.known_columns(t) for t in trials)]
    return np.concatenate(parts, axis=-1)


def _projected(
    problem: Problem, state: Fit, trials: Sequence[Template], columns: np.ndarray
) -> tuple[np.ndarray, np.ndarray, list[np.ndarray]]:
    """Return gram and slope of the templates after projection, and each template's positions."""
    p = problem.nuisance.shape[-1]
    base = p + active_columns(state).shape[-1]
    gram, slope, _ = normal_equations(problem, state, columns)
    slope[:p] -= state.z
    gram[np.arange(p), np.arange(p)] += np.where(_at_end(problem, state.z, slope[:p]), FIXED, 1.0)
    # A cause that does nothing where it stands has a column of zeros.
    inner = gram[:base, :base] + 1e-12 * np.diag(np.diag(gram)[:base] + 1.0)
    solved = np.linalg.solve(inner, np.c_[gram[:base, base:], slope[:base]])
    gram_t = gram[base:, base:] - gram[base:, :base] @ solved[:, :-1]
    slope_t = slope[base:] - gram[base:, :base] @ solved[:, -1]
    ends = np.cumsum([t.columns.shape[-1] for t in trials])
    at = [np.arange(e - t.columns.shape[-1], e) for e, t in zip(ends, trials, strict=True)]
    return gram_t, slope_t, at


def _at_end(problem: Problem, z: np.ndarray, slope: np.ndarray) -> np.ndarray:
    """Return which nuisances explain no more, (p,): at their tolerance's end, or pressed there.

    A physical range may end at the nominal value itself, from where the other way is free.
    """
    book = problem.book
    low, high = (z < book.lowest + NEAR) & (slope < 0.0), (z > book.highest - NEAR) & (slope > 0.0)
    return np.asarray((np.abs(z) > FURTHEST - NEAR) | low | high)


def _gains(
    problem: Problem, state: Fit, trials: Sequence[Template], columns: np.ndarray
) -> np.ndarray:
    gram, slope, at = _projected(problem, state, trials, columns)
    gains = np.zeros(len(trials))
    for i, t in enumerate(trials):
        g, b = gram[np.ix_(at[i], at[i])], slope[at[i]]
        if np.trace(g) > 1e-9:
            low, high = _reach(problem, t)
            try:
                u = bounded(g, b, low, high)
            except NUMERICAL:
                # Last in the order; its own linear fit says why, if it comes to that.
                continue
            gains[i] = 2.0 * b @ u - u @ g @ u
    return gains


def _gain(gram: np.ndarray, slope: np.ndarray, at: np.ndarray) -> float:
    g = gram[np.ix_(at, at)]
    return float(slope[at] @ np.linalg.lstsq(g, slope[at], rcond=1e-9)[0])


def _reach(problem: Problem, t: Template) -> tuple[np.ndarray, np.ndarray]:
    """Return the bounds of a template's coordinates."""
    low, high = bounds(problem.book.hypotheses[t.hypothesis])
    free = list(t.free)
    unit = np.where(t.unit == 0.0, 1.0, t.unit)
    a, b = (low - t.start)[free] / unit, (high - t.start)[free] / unit
    low, high = np.minimum(a, b) - 1e-9, np.maximum(a, b) + 1e-9
    low[0] = max(low[0], min(t.least - 1e-9, high[0]))
    high[0] = max(min(high[0], t.most + 1e-9), low[0] + 1e-9)
    return low, high


def start_of(problem: Problem, now: Fit, trial: Template) -> Score:
    """Return one template's linear fit, within all bounds, from where a model stands."""
    columns = _stack(problem, now, [trial])
    p, k = problem.nuisance.shape[-1], len(trial.free)
    a = columns.shape[-1] - p - k
    reach = _reach(problem, trial)
    free = np.full(a, np.inf)
    low = np.r_[problem.book.lowest - now.z - 1e-9, -free, reach[0]]
    high = np.r_[problem.book.highest - now.z + 1e-9, free, reach[1]]
    gram, slope, _ = normal_equations(problem, now, columns)
    gram[np.arange(p), np.arange(p)] += 1.0
    slope[:p] -= now.z
    x = bounded(gram, slope, low, high)
    best = assess(problem, now.z + x[:p], now.values, now.residual + columns @ x)
    values = {n: v.copy() for n, v in now.values.items()}
    h = problem.book.hypotheses[trial.hypothesis]
    values[trial.hypothesis] = np.clip(trial.values(x[-k:]), *bounds(h))
    z = problem.book.inside(now.z + x[:p])
    # The hypothesis carries what a nuisance at its tolerance's end stood in for.
    z[[problem.book.index[n] for n in h.competes if n in problem.book.index]] = 0.0
    return Score(trial.hypothesis, now.misfit - best.misfit, z, values)
