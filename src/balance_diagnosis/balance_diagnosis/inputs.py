"""Bad input, told in one line before anything is fitted.

What can be seen in one number alone is refused where it is made: ``Model``, ``Record``, the priors.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from difflib import get_close_matches

import numpy as np

from balance_diagnosis.constants import Constants
from balance_diagnosis.errors import BalanceError
from balance_diagnosis.evidence import limits
from balance_diagnosis.model import Model, Prediction
from balance_diagnosis.problem import Problem
from balance_diagnosis.record import Record

RUN = 8
"""Samples in a row that are the same in all channels, and move: no chance."""

NEAR = 0.75
"""Likeness of two names that are one, misspelled."""

SHARED = 0.02
"""Share of such runs of a hold-out record from which it overlaps."""


def check_model(model: Model) -> None:
    """Refuse what is no model."""
    if not isinstance(model, Model):
        raise BalanceError(
            f"give diagnose a Model, not {type(model).__name__}: Model(predict, ...)"
        )


def check_records(fit: Sequence[Record], holdout: Sequence[Record]) -> None:
    """Refuse no records, one name or the same bytes twice, and a hold-out that was fitted."""
    if isinstance(fit, Record) or isinstance(holdout, Record):
        raise BalanceError("fit and holdout are lists of records: write fit=[record]")
    if not fit:
        raise BalanceError("there is no record to fit: give fit=[record]")
    every = [*fit, *holdout]
    for record in every:
        if not isinstance(record, Record):
            raise BalanceError(f"fit and holdout hold records, not {type(record).__name__}")
    if len({id(record) for record in every}) < len(every):
        raise BalanceError("one record is given twice: give each once, to fit or to holdout")
    names = [record.name for record in every]
    twice = next((name for name in names if names.count(name) > 1), None)
    if twice is not None:
        raise BalanceError(f"two records are called '{twice}': give each a name, Record(name=...)")
    seen: dict[str, Record] = {}
    for record in every:
        twin = seen.setdefault(record.digest(), record)
        if twin is not record:
            raise BalanceError(
                f"records '{twin.name}' and '{record.name}' are the same bytes: give each once"
            )
    for held in holdout:
        for record in fit:
            share = _overlap(record, held)
            if share > SHARED:
                raise BalanceError(
                    f"{share:.0%} of the hold-out '{held.name}' are samples of '{record.name}', "
                    "which is fitted: hold out other data"
                )


def _overlap(record: Record, held: Record) -> float:
    """Return the share of runs of a record that another has as well, in the channels of both."""
    shared = sorted(set(record.channels) & set(held.channels))
    if not shared:
        return 0.0
    known, runs = (_runs(np.stack([r[c] for c in shared], axis=1)) for r in (record, held))
    return float(np.isin(runs, known).mean()) if len(runs) else 0.0


def _runs(rows: np.ndarray) -> np.ndarray:
    """Return a hash of each run of samples that moves, (runs,) of 64 bits."""
    if len(rows) < RUN:
        return np.zeros(0, np.uint64)
    moves = np.any(np.nan_to_num(np.diff(rows, axis=0)) != 0.0, axis=1)
    moving = np.convolve(moves, np.ones(RUN - 1), "valid") >= RUN // 2
    draw = np.random.default_rng(0)
    odd = [draw.integers(2**63, size=n, dtype=np.uint64) * 2 + 1 for n in (rows.shape[1], RUN)]
    bits = np.ascontiguousarray(rows).view(np.uint64)
    one = (bits ^ (bits >> np.uint64(29))) * odd[0]
    each = (one ^ (one >> np.uint64(32))).sum(axis=1, dtype=np.uint64)
    count = len(rows) - RUN + 1
    run = sum((each[k : k + count] * odd[1][k] for k in range(RUN)), np.zeros(count, np.uint64))
    return run[moving]


def check_holdout(model: Model, holdout: Sequence[Record], constants: Constants) -> None:
    """Refuse a hold-out that the model cannot predict, before anything is fitted."""
    if holdout:
        check_prediction(Problem(model, holdout, constants))


def check_prediction(problem: Problem) -> None:
    """Refuse a prediction that is not the same twice, changes the record, or misses a name."""
    for number, record in enumerate(problem.records):
        values = problem.values((), np.zeros(len(problem.common)), number)
        before = record.digest()
        made, again = (problem.predicted(number, values) for _ in range(2))
        if record.digest() != before:
            raise BalanceError(
                f"predict changes the channels of record '{record.name}': let it work on copies"
            )
        for key, output in made.outputs.items():
            if not np.array_equal(output, again.outputs[key], equal_nan=True):
                raise BalanceError(
                    f"predict returns another '{key}' each time it is called with the same numbers:"
                    " it has to be deterministic"
                )
        _check_names(made, record)


def _check_names(made: Prediction, record: Record) -> None:
    """Refuse a channel that would silently not be judged, since its prediction is misspelled."""
    silent = [key for key in record.channels if key not in made.outputs]
    lowered = {key.lower(): key for key in silent}
    for name in made.states:
        near = get_close_matches(name.lower(), list(lowered), n=1, cutoff=NEAR)
        if near:
            raise BalanceError(
                f"predict returns '{name}', and record '{record.name}' has '{lowered[near[0]]}', "
                "which would not be judged: spell both alike"
            )


def check_response(problem: Problem) -> None:
    """Refuse a model whose outputs depend on no parameter, and a start that changes nothing."""
    low, high = limits(problem, ())
    x = np.zeros(len(low))
    base = problem.residual((), x)
    if not len(x) or base is None:
        return

    def moves(i: int) -> bool:
        for place in (min(1.0, high[i]), max(-1.0, low[i])):
            moved = x.copy()
            moved[i] = 0.5 * place
            made = problem.residual((), moved)
            if made is None or np.abs(made - base).max() > 1e-12 * np.abs(base).max():
                return True
        return False

    slots = problem.slots(())
    for name in problem.model.starts:
        places = [i for i, slot in enumerate(slots) if slot.name == name]
        if not any(moves(i) for i in places):
            states = getattr(problem.model.predict, "states", ())
            known = f"; the states are {_listed(states)}" if states else ""
            raise BalanceError(f"no output depends on the start '{name}'{known}: is it a state?")
    if not any(moves(i) for i in range(len(x))):
        raise BalanceError(
            f"no output depends on any parameter ({_listed(s.name for s in slots)}): "
            "does predict use p?"
        )


def _listed(names: Iterable[str]) -> str:
    return ", ".join(f"'{name}'" for name in names)
