"""What the extended model gains, told of each record; it selects nothing."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from balance_diagnosis.evidence import Fit
from balance_diagnosis.problem import Problem
from balance_diagnosis.record import Record


@dataclass(frozen=True)
class Gain:
    """Rms errors of one output of one record, in its unit. held_out: the record was not fitted."""

    record: str
    output: str
    nominal: float
    extended: float
    held_out: bool


def gains(
    problem: Problem, nominal: Fit, extended: Fit, records: Sequence[Record], fitted: int
) -> list[Gain]:
    """Return the errors of both models. Of records beyond the fitted ones the starts are fitted."""
    found = []
    for number, record in enumerate(records):
        errors = [error_of(problem, fit, record, number, fitted) for fit in (nominal, extended)]
        for key in errors[0]:
            before, after = (float(np.sqrt(np.nanmean(e[key] ** 2))) for e in errors)
            found.append(Gain(record.name, key, before, after, number >= fitted))
    return found


def error_of(
    problem: Problem, fit: Fit, record: Record, number: int, fitted: int
) -> dict[str, np.ndarray]:
    """Return measured minus predicted at every sample, output to (n,); NaN where not judged."""
    if number < fitted:
        values = problem.values(fit.names, fit.x, number)
    else:
        values = started(problem, fit, record)
    made = problem.model.predicted(values, record)
    return {key: record[key] - output for key, output in made.outputs.items()}


def started(problem: Problem, fit: Fit, record: Record) -> dict[str, float]:
    """Return the numbers of a fit with the starts of another record fitted to it."""
    from scipy.optimize import least_squares

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
    return values | {
        s.name: s.prior.value(float(v)) for s, v in zip(starts, found.x, strict=True)
    }
