"""The way from records to a verdict."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from balance_diagnosis.constants import DEFAULT, Constants
from balance_diagnosis.evidence import Criterion, Fit, Noise, limits
from balance_diagnosis.extended import Extended
from balance_diagnosis.held_out import Curve, Gain, curves, gains
from balance_diagnosis.inputs import (
    check_holdout,
    check_model,
    check_prediction,
    check_records,
    check_response,
)
from balance_diagnosis.intervals import Estimate, estimates
from balance_diagnosis.model import Model, Prediction
from balance_diagnosis.noise import Scenery, estimate, spikes
from balance_diagnosis.problem import Problem
from balance_diagnosis.record import Record
from balance_diagnosis.remaining import Band, bands
from balance_diagnosis.screen import trials
from balance_diagnosis.search import Search
from balance_diagnosis.verdicts import Verdict, decide

if TYPE_CHECKING:
    from balance_diagnosis.calibration import Rates

ROUNDS = 3
"""Of noise about the best set, and search in that noise; two, or the best set stays the same."""

STARTS = 8
"""Nominal fits from different places, where bounds are all that is known of a parameter."""


@dataclass(frozen=True)
class Diagnosis:
    """What was found. numbers: all of the extended model. nominal: of the one without causes."""

    model: Model
    fit: tuple[Record, ...]
    holdout: tuple[Record, ...]
    constants: Constants
    verdict: Verdict
    numbers: tuple[Estimate, ...]
    nominal: tuple[Estimate, ...]
    typical: dict[str, dict[str, float]]
    noise: dict[str, float]
    gains: tuple[Gain, ...]
    remaining: tuple[Band, ...]
    curves: tuple[Curve, ...]
    calls: int
    failures: dict[str, int]

    def __str__(self) -> str:
        from balance_diagnosis.report.data import output_units
        from balance_diagnosis.report.words import gained, sentence

        told = f"{self.verdict.word}. {sentence(self)} {gained(self, output_units(self))}"
        return told.strip()

    @property
    def causes(self) -> dict[str, dict[str, Estimate]]:
        """The causes of the best set with their numbers, named or not."""
        found: dict[str, dict[str, Estimate]] = {}
        for number in self.numbers:
            if number.cause:
                found.setdefault(number.cause, {})[number.name] = number
        return found

    @property
    def extended(self) -> Extended:
        """The model with what was found, to be run on any record."""
        return Extended.of(self.model, self.numbers)

    def predicted(self, record: Record, **starts: float) -> Prediction:
        """Return what the extended model predicts. starts: of a record that was not fitted."""
        return self.extended.predicted(record, **starts)

    def write(self, folder: str | Path, rates: Rates | None = None, call: str = "") -> Path:
        """Write page.html, report.json and extended_model.yaml; return the page's path.

        call: the command that made it, where it was not a program. BalanceError where the folder
        cannot be written.
        """
        from balance_diagnosis.report.write import write

        return write(self, Path(folder), rates, call)


def diagnose(
    model: Model,
    fit: Sequence[Record],
    holdout: Sequence[Record] = (),
    constants: Constants = DEFAULT,
) -> Diagnosis:
    """Name what a model gets wrong about the records ``fit``.

    holdout: records that only tell what the extended model gains; they select nothing. BalanceError
    where model or records are used wrongly.
    """
    check_model(model)
    if not isinstance(fit, Record) and not isinstance(holdout, Record):
        fit, holdout = tuple(fit or ()), tuple(holdout or ())
    check_records(fit, holdout)
    check_holdout(model, holdout, constants)
    problem = Problem(model, fit, constants)
    check_prediction(problem)
    check_response(problem)
    x = nominal_fit(problem)
    problem.reduce((), x)
    problem.learn(x)
    search, best, scenery = _searched(problem, x)
    plain = Criterion(problem, search.criterion.noise, np.zeros((problem.count, 0))).fit(
        (), [best.x[: len(x)], x]
    )
    assert plain is not None
    verdict = decide(search, best, plain, scenery)
    noise = {
        f"{s.output} of {problem.records[s.record].name}": float(search.criterion.noise.sd[span][0])
        for s, span in zip(problem.rows, problem.spans, strict=True)
    }
    told = curves(problem, plain, best, [*fit, *holdout], len(fit))
    return Diagnosis(
        model,
        tuple(fit),
        tuple(holdout),
        constants,
        verdict,
        tuple(estimates(search.criterion, best)),
        tuple(estimates(search.criterion, plain)),
        {name: dict(probed.typical) for name, probed in problem.probed.items()},
        noise,
        tuple(gains(told)),
        tuple(bands(told)),
        tuple(told),
        problem.calls,
        dict(problem.failures),
    )


def nominal_fit(problem: Problem) -> np.ndarray:
    """Return the coordinates of the nominal model, (k,): the best fit of several starts.

    Nothing is known of the noise yet: it is taken for next to none, so that the logarithm of the
    error's energy is minimised beside the priors.
    """
    scale = np.concatenate(
        [np.full(len(s), 1e-3 * problem.scale[s.record, s.output]) for s in problem.rows]
    )
    outputs = len(problem.outputs)
    facts = np.full(outputs, problem.constants.facts / outputs)
    criterion = Criterion(
        problem, Noise(scale, np.zeros(outputs), facts), np.zeros((problem.count, 0))
    )
    low, high = limits(problem, ())
    draw = np.random.default_rng(0)
    wide = np.isfinite(low) & (high - low < 4.0 + 1e-9)
    starts = [np.zeros(len(low))]
    more = STARTS - 1 if wide.any() else 0
    starts += [np.where(wide, draw.uniform(0.9 * low, 0.9 * high), 0.0) for _ in range(more)]
    best = criterion.fit((), starts)
    assert best is not None
    return best.x


def _searched(problem: Problem, x: np.ndarray) -> tuple[Search, Fit, Scenery]:
    """Return the search in the last noise, its best set, and the functions for the check."""
    names: tuple[str, ...] = ()
    place, nominal = x, x
    for _ in range(ROUNDS):
        scenery = Scenery(problem, names, place)
        about = _bare(problem, names, place)
        others = [cause for cause in problem.model.causes if cause not in names]
        tried = trials(problem, about, others)
        noise = estimate(problem, scenery, names, place, [t.change for t in tried])
        typical = {t.cause: t.change for t in tried if t.numbers == problem.probed[t.cause].start}
        typical |= {name: _typical_change(problem, about, name) for name in names}
        criterion = Criterion(problem, noise, spikes(problem, typical))
        search = Search(criterion, nominal)
        start = search.fit(names, [place])
        empty = search.fit((), [place[: len(x)], nominal])
        assert empty is not None
        current = start if start is not None and start.evidence > empty.evidence else empty
        best = search.climb(current)
        again = set(best.names) != set(names)
        names, place = best.names, best.x
        if not again:
            break
    search.around(best)
    best = max((f for f in search.met.values() if f is not None), key=lambda f: f.evidence)
    return search, best, scenery


def _bare(problem: Problem, names: tuple[str, ...], x: np.ndarray) -> Fit:
    empty = np.zeros(0)
    return Fit(names, x, x, empty, empty, empty, empty, 0.0)


def _typical_change(problem: Problem, about: Fit, name: str) -> np.ndarray:
    """Return what a cause of the set does at its typical size, about the same model without it."""
    kept = [slot.cause != name for slot in problem.slots(about.names)]
    lean = _bare(problem, tuple(n for n in about.names if n != name), about.x[kept])
    (made,) = trials(problem, lean, [name], typical=True) or (None,)
    return np.zeros(problem.count) if made is None else made.change
