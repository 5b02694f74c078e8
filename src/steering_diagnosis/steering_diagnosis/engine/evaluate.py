"""Calls of the replay: points, decimated residuals, in parallel where an executor is given."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from concurrent.futures import Executor
from dataclasses import dataclass, field
from functools import cached_property

import numpy as np

from steering_diagnosis.engine.model import Effects, Replay
from steering_diagnosis.engine.sampling import Sampling

CHUNK = 4
"""Calls per task: the replay travels with each task."""


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


def evaluate(replay: Replay, grid: Sampling, calls: Sequence[Call]) -> list[np.ndarray]:
    """Return the decimated residuals of the calls, (n, outputs) each; runs in workers."""
    return [grid.reduce(replay.residuals(c.nuisances, c.effects)) for c in calls]


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
        self._last: dict[tuple[object, ...], np.ndarray] = {}
        self._shaken: dict[tuple[object, ...], np.ndarray] = {}

    @property
    def shaken(self) -> np.ndarray:
        """What another draw of the inputs' noise changes in the nominal model, (n, outputs)."""
        return self.shaken_in(Call())

    def shaken_in(self, call: Call) -> np.ndarray:
        """Return the same in another model, (n, outputs), unknown samples zero."""
        if call.key not in self._shaken:
            changed = self.replay.shaken(call.nuisances, call.effects)
            self._shaken[call.key] = np.nan_to_num(self.grid.reduce(changed))
        return self._shaken[call.key]

    @cached_property
    def own(self) -> np.ndarray:
        """Mean squares of the outputs' own noise in the band, zero where unknown, (outputs,)."""
        band = 2.0 * self.grid.bandwidth_hz * self.grid.period_s
        return self.replay.noise() ** 2 * min(band, 1.0)

    def one(self, call: Call) -> np.ndarray:
        """Return the residual of one call, (n, outputs)."""
        return self.many([call])[0]

    def many(self, calls: Sequence[Call]) -> list[np.ndarray]:
        """Return the residuals of several calls, in their order."""
        todo = list({c.key: c for c in calls if c.key not in self._last}.values())
        found = {k: self._last[k] for k in (c.key for c in calls) if k in self._last}
        for part, values in self._run(todo):
            found.update(zip((c.key for c in part), values, strict=True))
            self.calls += len(part)
            self._on_call(self.calls)
        self._last = {**self._last, **found} if len(self._last) < 64 else found
        return [found[c.key] for c in calls]

    def _run(self, calls: list[Call]):  # type: ignore[no-untyped-def]
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
