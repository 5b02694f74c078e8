"""What the extended model gains, told of each record; it selects nothing."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from scipy.optimize import least_squares

from balance_diagnosis.evidence import Fit
from balance_diagnosis.problem import Problem
from balance_diagnosis.record import Record


@dataclass(frozen=True)
class Curve:
    """One output of one record: times [s], measured and both predictions, (n,) in its unit.

    measured is NaN where nothing is judged. held_out: the record was not fitted.
    """

    record: str
    output: str
    held_out: bool
    times: np.ndarray
    measured: np.ndarray
    nominal: np.ndarray
    extended: np.ndarray


@dataclass(frozen=True)
class Gain:
    """Rms errors of one output of one record, in its unit. held_out: the record was not fitted."""

    record: str
    output: str
    nominal: float
    extended: float
    held_out: bool


def curves(
    problem: Problem, nominal: Fit, extended: Fit, records: Sequence[Record], fitted: int
) -> list[Curve]:
    """Return what both models predict. Of records beyond the fitted ones the starts are fitted."""
    found = []
    for number, record in enumerate(records):
        before, after = (
            problem.model.predicted(_values(problem, fit, record, number, fitted), record).outputs
            for fit in (nominal, extended)
        )
        found += [
            Curve(
                record.name,
                key,
                number >= fitted,
                record.times,
                record[key],
                before[key],
                after[key],
            )
            for key in before
        ]
    return found


def gains(told: Sequence[Curve]) -> list[Gain]:
    """Return the errors of both models."""
    return [
        Gain(
            c.record,
            c.output,
            _rms(c.measured - c.nominal),
            _rms(c.measured - c.extended),
            c.held_out,
        )
        for c in told
    ]


def _rms(error: np.ndarray) -> float:
    judged = error[np.isfinite(error)]
    return float(np.sqrt(np.mean(judged**2))) if len(judged) else float("nan")


def _values(
    problem: Problem, fit: Fit, record: Record, number: int, fitted: int
) -> dict[str, float]:
    if number < fitted:
        return problem.values(fit.names, fit.x, number)
    return started(problem, fit, record)


def started(problem: Problem, fit: Fit, record: Record) -> dict[str, float]:
    """Return the numbers of a fit with the starts of another record fitted to it."""
    slots = problem.slots(fit.names)
    values = {
        slot.name: slot.prior.value(float(x))
        for slot, x in zip(slots, fit.x, strict=True)
        if slot.record is None
    }
    if not problem.model.starts:
        return values
    fresh = Problem(problem.model, [record], problem.constants)
    starts = [slot for slot in fresh.common if slot.record is not None]

    def errors(x: np.ndarray) -> np.ndarray:
        placed = {s.name: s.prior.value(float(v)) for s, v in zip(starts, x, strict=True)}
        part = fresh.part(0, {**values, **placed})
        return np.full(fresh.count, 1e6) if part is None else np.concatenate(part)

    ends = np.array([s.prior.limits for s in starts])
    found = min(
        (
            least_squares(errors, np.full(len(starts), x), bounds=(ends[:, 0], ends[:, 1]))
            for x in (0.0, -0.5, 0.5)
        ),
        key=lambda made: made.cost,
    )
    return values | {s.name: s.prior.value(float(v)) for s, v in zip(starts, found.x, strict=True)}
