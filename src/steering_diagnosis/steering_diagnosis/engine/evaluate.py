"""Calls of the replay: points, decimated residuals, in parallel where an executor is given."""

from __future__ import annotations

from collections import OrderedDict
from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import Executor
from dataclasses import dataclass, field
from functools import cached_property

import numpy as np

from steering_core.errors import BenchError
from steering_diagnosis.engine.failures import OF_A_REPLAY, CandidateError, reason
from steering_diagnosis.engine.model import Effects, Replay
from steering_diagnosis.engine.sampling import Sampling

CHUNK = 4
"""Calls per task: the replay travels with each task."""

KEPT_SHAKEN = 8
"""Models whose answer to the inputs' noise is kept: those that are compared with each other."""

LARGEST = 1e50
"""Residual [SI] from which a model diverges: sums of its squares in any unit are still numbers."""


@dataclass(frozen=True)
class Call:
    """Arguments of one replay: absolute nuisances and effects."""

    nuisances: dict[str, float] = field(default_factory=dict)
    effects: Effects = field(default_factory=dict)

    @property
    def key(self) -> tuple[object, ...]:
        """Return a key for the cache."""
        effects = sorted((name, tuple(sorted(p.items()))) for name, p in self.effects.items())
        return (tuple(sorted(self.nuisances.items())), tuple(effects))


@dataclass(frozen=True)
class Failed:
    """In the place of residuals: why a call gave none."""

    why: str


Answer = np.ndarray | Failed


def evaluate(replay: Replay, grid: Sampling, calls: Sequence[Call]) -> list[Answer]:
    """Return the decimated residuals of the calls, (n, outputs) each; runs in workers.

    A call that fails costs none of the others.
    """
    return [_answer(replay, grid, call) for call in calls]


def _answer(replay: Replay, grid: Sampling, call: Call) -> Answer:
    try:
        raw = replay.residuals(call.nuisances, call.effects)
    except OF_A_REPLAY as error:
        return Failed(reason(error))
    if np.any(np.abs(raw) > LARGEST):
        return Failed("its error grows beyond all numbers")
    return grid.reduce(raw)


class Evaluator:
    """Residuals of one record on the decimated grid; every call is made once."""

    def __init__(
        self,
        replay: Replay,
        grid: Sampling,
        executor: Executor | None = None,
        on_call: Callable[[int], None] = lambda _: None,
    ) -> None:
        self.replay = replay
        self.grid = grid
        self.calls = 0
        self._executor = executor
        self._on_call = on_call
        self._last: dict[tuple[object, ...], Answer] = {}
        self._shaken: OrderedDict[tuple[object, ...], np.ndarray] = OrderedDict()

    @cached_property
    def base(self) -> np.ndarray:
        """Residuals of the nominal model, (n, outputs). BenchError: it cannot be replayed."""
        found = self.answers([Call()])[0]
        if isinstance(found, Failed):
            raise BenchError(f"the nominal model cannot follow the record: {found.why}")
        if not np.isfinite(found).any():
            raise BenchError("the nominal model gives no number anywhere in the record")
        return found

    @cached_property
    def valid(self) -> np.ndarray:
        """Where the nominal model gives a number, and every other model has to, (n, outputs)."""
        return np.isfinite(self.base)

    @property
    def shaken(self) -> np.ndarray:
        """What another draw of the inputs' noise changes in the nominal model, (n, outputs)."""
        return self.shaken_in(Call())

    def shaken_in(self, call: Call) -> np.ndarray:
        """Return the same in another model, (n, outputs), unknown samples zero."""
        if call.key not in self._shaken:
            try:
                changed = self.replay.shaken(call.nuisances, call.effects)
            except OF_A_REPLAY as error:
                raise CandidateError(reason(error)) from None
            self._shaken[call.key] = np.nan_to_num(self.grid.reduce(changed))
        self._shaken.move_to_end(call.key)
        while len(self._shaken) > KEPT_SHAKEN:
            self._shaken.popitem(last=False)
        return self._shaken[call.key]

    @cached_property
    def own(self) -> np.ndarray:
        """Mean squares of the outputs' own noise in the band, zero where unknown, (outputs,)."""
        band = 2.0 * self.grid.bandwidth_hz * self.grid.period_s
        return self.replay.noise() ** 2 * min(band, 1.0)

    def one(self, call: Call) -> np.ndarray:
        """Return the residual of one call, (n, outputs). CandidateError: there is none."""
        found = self.answers([call])[0]
        if isinstance(found, Failed):
            raise CandidateError(found.why)
        return found

    def answers(self, calls: Sequence[Call]) -> list[Answer]:
        """Return the residuals of several calls, or why there are none, in their order."""
        todo = list({c.key: c for c in calls if c.key not in self._last}.values())
        found = {k: self._last[k] for k in (c.key for c in calls) if k in self._last}
        for part, values in self._run(todo):
            for call, value in zip(part, values, strict=True):
                found[call.key] = self._judged(call, value)
            self.calls += len(part)
            self._on_call(self.calls)
        self._last = {**self._last, **found} if len(self._last) < 64 else found
        return [found[c.key] for c in calls]

    def _judged(self, call: Call, value: Answer) -> Answer:
        """Return an answer; a failure where there is no number although the nominal model has."""
        if isinstance(value, Failed) or call.key == Call().key:
            return value
        missing = np.count_nonzero(self.valid & ~np.isfinite(value))
        if not missing:
            return value
        return Failed(f"it gives no number at {missing} samples where the nominal model does")

    def _run(self, calls: list[Call]) -> Iterator[tuple[list[Call], list[Answer]]]:
        if self._executor is None or len(calls) < 2:
            for call in calls:
                yield [call], evaluate(self.replay, self.grid, [call])
            return
        parts = [calls[i : i + CHUNK] for i in range(0, len(calls), CHUNK)]
        if len(calls) <= 2 * CHUNK:
            parts = [[c] for c in calls]
        tasks = [self._executor.submit(evaluate, self.replay, self.grid, p) for p in parts]
        for part, task in zip(parts, tasks, strict=True):
            yield part, task.result()
