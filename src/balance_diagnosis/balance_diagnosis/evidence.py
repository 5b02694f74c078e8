"""The criterion: log evidence of a set of causes, at its most probable numbers.

Of output j, D_j is the error beyond noise in independent samples. What no cause explains is K
unknown directions of one common variance, so that

    log p(r | theta) = - sum_j K_j / 2 log(1 + D_j / K_j),    D_j = max(0, |r_j / sd|^2 - n_j)

that is -D/2 where D is far below K, and K/2 times the log of the energy where it is far above,
however long the record. All coordinates are standard normal. All causes are there all the
same, small and linear ("spikes"), those of the set as well: a formula is never quite right. The
integral over the coordinates is Laplace's, one-sided where one of them stands at its bound.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from scipy.special import erfcx, ndtr

from balance_diagnosis.problem import Problem

EDGE = 1e-6
STEP = 1e-3
ITERATIONS = 25
FIRST_STEPS, FOLLOWED = 4, 2
"""Steps that every start is followed, and starts that are followed to the end."""

DAMPINGS = 6
LONGEST = 3.0
ENOUGH = 0.01
"""Gain in nats from which a step is worth another."""


@dataclass(frozen=True, repr=False)
class Noise:
    """sd: of each row, such that rows over it have n_eff independent samples of variance one.

    samples: n of each output. facts: K of each output.
    """

    sd: np.ndarray
    samples: np.ndarray
    facts: np.ndarray


@dataclass(frozen=True, repr=False)
class Fit:
    """A model at its most probable numbers.

    x: its coordinates. residual, columns: over the noise's deviation; columns have the spikes last.
    whole: coordinates and spikes. excess: D of each output. evidence: log p(r, M), in nats.
    """

    names: tuple[str, ...]
    x: np.ndarray
    whole: np.ndarray
    residual: np.ndarray
    columns: np.ndarray
    excess: np.ndarray
    weights: np.ndarray
    evidence: float
    at_bound: tuple[str, ...] = ()


@dataclass(frozen=True, repr=False)
class _Bounds:
    """A set of causes with its coordinates' bounds, spikes last. count: those without spikes."""

    names: tuple[str, ...]
    count: int
    extra: np.ndarray | None
    low: np.ndarray
    high: np.ndarray


@dataclass(frozen=True, repr=False)
class _Place:
    """Where a climb is. raw: residual without spikes. residual: over the noise, with them."""

    bounds: _Bounds
    whole: np.ndarray
    raw: np.ndarray
    residual: np.ndarray
    excess: np.ndarray
    cost: float


class Criterion:
    """Fits and judges models of one problem in one noise.

    spikes: (rows, causes), what each cause changes at its least size, or (rows, 0).
    """

    def __init__(self, problem: Problem, noise: Noise, spikes: np.ndarray) -> None:
        self.problem, self.noise, self.spikes = problem, noise, spikes
        count = len(problem.model.causes)
        self.prior = min(problem.constants.expected / count, 0.25)

    def excess(self, residual: np.ndarray) -> np.ndarray:
        """Return D of each output for residuals over the noise's deviation."""
        energy = np.bincount(self.problem.output_of, residual**2, len(self.noise.samples))
        return np.maximum(energy - self.noise.samples, 0.0)

    def misfit(self, excess: np.ndarray) -> float:
        """Return minus the log likelihood, up to a constant."""
        k = self.noise.facts
        return 0.5 * float(k @ np.log1p(excess / k))

    def row_weights(self, excess: np.ndarray) -> np.ndarray:
        """Return how much each row counts beside what is left: 1 / (1 + D / K), (rows,)."""
        return (1.0 / (1.0 + excess / self.noise.facts))[self.problem.output_of]

    def fit(self, names: Sequence[str], starts: Sequence[np.ndarray]) -> Fit | None:
        """Return the best fit from some starts; None where the model fails at all of them.

        All starts are followed for a few steps, the best of them to the end.
        """
        names = tuple(names)
        begun = [self._begin(names, x) for x in starts]
        places = [self._climb(place, FIRST_STEPS) for place in begun if place is not None]
        places.sort(key=lambda place: place.cost)
        ended = [self._climb(place, ITERATIONS) for place in places[:FOLLOWED]]
        found = [self._judged(place) for place in ended]
        return max(found, key=lambda fit: fit.evidence, default=None)

    # --- the most probable numbers, by bounded Gauss-Newton steps

    def _begin(self, names: tuple[str, ...], start: np.ndarray) -> _Place | None:
        extra = self.spikes if self.spikes.size else None
        low, high = limits(self.problem, names)
        if extra is not None:
            low = np.r_[low, np.full(extra.shape[1], -np.inf)]
            high = np.r_[high, np.full(extra.shape[1], np.inf)]
        whole = np.zeros(len(low))
        whole[: len(start)] = np.clip(start, low[: len(start)], high[: len(start)])
        return self._at(_Bounds(names, len(start), extra, low, high), whole)

    def _at(self, bounds: _Bounds, whole: np.ndarray) -> _Place | None:
        """Return the residual at coordinates and spikes; None where the model fails."""
        raw = self.problem.residual(bounds.names, whole[: bounds.count])
        if raw is None:
            return None
        extra = bounds.extra
        beside = raw if extra is None else raw - extra @ whole[bounds.count :]
        residual = beside / self.noise.sd
        excess = self.excess(residual)
        cost = self.misfit(excess) + 0.5 * float(whole @ whole)
        return _Place(bounds, whole, raw, residual, excess, cost)

    def _climb(self, place: _Place, iterations: int) -> _Place:
        damping = 1e-3
        for _ in range(iterations):
            columns = self._columns(place)
            weighted = columns.T * self.row_weights(place.excess)
            gram = weighted @ columns + np.eye(len(place.whole))
            slope = weighted @ place.residual + place.whole
            low, high = place.bounds.low, place.bounds.high
            better = None
            for _ in range(DAMPINGS):
                step = _bounded_step(gram, slope, damping, place.whole, low, high)
                there = np.clip(place.whole + np.clip(step, -LONGEST, LONGEST), low, high)
                tried = self._at(place.bounds, there)
                if tried is not None and tried.cost < place.cost:
                    better = tried
                    break
                damping = max(8.0 * damping, 1e-3)
            if better is None:
                break
            gained, place = place.cost - better.cost, better
            damping *= 0.2
            if gained < ENOUGH:
                break
        return place

    def _columns(self, place: _Place) -> np.ndarray:
        """Return the derivatives of the residuals over the noise's deviation, (rows, k)."""
        at = place.bounds
        own = derivatives(self.problem, at.names, place.whole[: at.count], place.raw)
        made = own if at.extra is None else np.concatenate([own, -at.extra], axis=1)
        return (made.T / self.noise.sd).T

    def _judged(self, place: _Place) -> Fit:
        """Return the fit with its evidence."""
        names, low, high = place.bounds.names, place.bounds.low, place.bounds.high
        whole, columns = place.whole, self._columns(place)
        weights = self.row_weights(place.excess)
        gram = (columns.T * weights) @ columns + np.eye(len(whole))
        slope = (columns.T * weights) @ place.residual + whole
        at_low, at_high = whole <= low + EDGE, whole >= high - EDGE
        edge = at_low | at_high
        value = -place.cost - float(_log_mass(low, high).sum())
        value -= 0.5 * float(np.linalg.slogdet(gram[np.ix_(~edge, ~edge)])[1])
        for i in np.flatnonzero(edge):
            push = slope[i] if at_low[i] else -slope[i]
            value += _log_one_sided(max(float(push), 0.0), float(gram[i, i]))
        absent = len(self.problem.model.causes) - len(names)
        value += len(names) * np.log(self.prior) + absent * np.log1p(-self.prior)
        slots, count = self.problem.slots(names), place.bounds.count
        return Fit(
            names,
            whole[:count],
            whole,
            place.residual,
            columns,
            place.excess,
            weights,
            float(value),
            tuple(slots[i].name for i in np.flatnonzero(edge[:count])),
        )


def limits(problem: Problem, names: Sequence[str]) -> tuple[np.ndarray, np.ndarray]:
    """Return the coordinates' bounds, (k,) each."""
    ends = np.array([slot.prior.limits for slot in problem.slots(names)]).reshape(-1, 2)
    return ends[:, 0], ends[:, 1]


def derivatives(
    problem: Problem, names: Sequence[str], x: np.ndarray, raw: np.ndarray
) -> np.ndarray:
    """Return the derivatives of the residuals by the coordinates, (rows, k), by differences.

    A start is varied on its own record only. Where the model fails beside x a column is zero.
    """
    slots, (_, high) = problem.slots(names), limits(problem, names)
    made = np.zeros((problem.count, len(x)))
    for i, slot in enumerate(slots):
        step = STEP if x[i] + STEP <= high[i] else -STEP
        moved = x.copy()
        moved[i] += step
        for number in range(len(problem.records)) if slot.record is None else (slot.record,):
            part = problem.part(number, problem.values(names, moved, number))
            if part is None:
                made[:, i] = 0.0
                break
            spans = [
                span
                for span, s in zip(problem.spans, problem.rows, strict=True)
                if s.record == number
            ]
            for span, rows in zip(spans, part, strict=True):
                made[span, i] = (rows - raw[span]) / step
    return made


def _bounded_step(
    gram: np.ndarray,
    slope: np.ndarray,
    damping: float,
    x: np.ndarray,
    low: np.ndarray,
    high: np.ndarray,
) -> np.ndarray:
    """Return a damped Newton step of the coordinates that are not pressed against a bound."""
    held = ((x <= low + EDGE) & (slope > 0.0)) | ((x >= high - EDGE) & (slope < 0.0))
    free = ~held
    inner = gram[np.ix_(free, free)]
    step = np.zeros(len(x))
    step[free] = -np.linalg.solve(inner + damping * np.diag(np.diag(inner)), slope[free])
    return step


def _log_mass(low: np.ndarray, high: np.ndarray) -> np.ndarray:
    """Return the log of a standard normal's mass between bounds."""
    return np.log(np.maximum(ndtr(high) - ndtr(low), 1e-300))


def _log_one_sided(push: float, curvature: float) -> float:
    """Return log of the integral of exp(-push t - curvature t^2 / 2) over t > 0, per sqrt(2 pi)."""
    scaled = push / np.sqrt(2.0 * curvature)
    return float(np.log(0.5 * erfcx(scaled) / np.sqrt(curvature)))
