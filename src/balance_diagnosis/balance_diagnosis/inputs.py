"""Bad input, told in one line before anything is fitted."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from balance_diagnosis.errors import BenchError
from balance_diagnosis.evidence import limits
from balance_diagnosis.problem import Problem
from balance_diagnosis.record import Record

RUN = 8
"""Samples in a row that are the same in all channels, and move: no chance."""

SHARED = 0.02
"""Share of such runs of a hold-out record from which it overlaps."""


def check_records(fit: Sequence[Record], holdout: Sequence[Record]) -> None:
    """Refuse no records, the same bytes twice, and a hold-out that was fitted."""
    if isinstance(fit, Record) or isinstance(holdout, Record):
        raise BenchError("fit and holdout are lists of records: write fit=[record]")
    if not fit:
        raise BenchError("there is no record to fit: give fit=[record]")
    every = [*fit, *holdout]
    for record in every:
        if not isinstance(record, Record):
            raise BenchError(f"fit and holdout hold records, not {type(record).__name__}")
    seen: dict[str, Record] = {}
    for record in every:
        twin = seen.setdefault(record.digest(), record)
        if twin is not record:
            raise BenchError(
                f"records '{twin.name}' and '{record.name}' are the same bytes: give each once"
            )
    if len({id(record) for record in every}) < len(every):
        raise BenchError("one record is given twice: give each once, to fit or to holdout")
    for held in holdout:
        for record in fit:
            share = _overlap(record, held)
            if share > SHARED:
                raise BenchError(
                    f"{share:.0%} of the hold-out '{held.name}' are samples of '{record.name}', "
                    "which is fitted: hold out other data"
                )


def _overlap(record: Record, held: Record) -> float:
    """Return the share of runs of a record that another has as well."""
    if set(record.channels) != set(held.channels):
        return 0.0
    known = set(_runs(record))
    runs = _runs(held)
    return sum(run in known for run in runs) / max(len(runs), 1)


def _runs(record: Record) -> list[bytes]:
    rows = np.ascontiguousarray(record.rows())
    moves = np.any(np.nan_to_num(np.diff(rows, axis=0)) != 0.0, axis=1)
    moving = np.convolve(moves, np.ones(RUN - 1), "valid") >= RUN // 2
    return [rows[i : i + RUN].tobytes() for i in np.flatnonzero(moving)]


def check_response(problem: Problem) -> None:
    """Refuse a model whose outputs depend on nothing that could be fitted."""
    low, high = limits(problem, ())
    x = np.zeros(len(low))
    base = problem.residual((), x)
    if not len(x) or base is None:
        return
    size = float(np.abs(base).max())
    for i in range(len(x)):
        for place in (min(1.0, high[i]), max(-1.0, low[i])):
            moved = x.copy()
            moved[i] = 0.5 * place
            made = problem.residual((), moved)
            if made is None or np.abs(made - base).max() > 1e-12 * size:
                return
    names = ", ".join(f"'{slot.name}'" for slot in problem.slots(()))
    raise BenchError(f"no output depends on any parameter ({names}): does predict use p?")
