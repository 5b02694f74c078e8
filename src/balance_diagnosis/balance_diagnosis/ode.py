"""From a differential equation to a prediction: classical Runge-Kutta steps, compiled."""

from __future__ import annotations

import re
from collections import namedtuple
from collections.abc import Callable, Mapping, Sequence
from functools import lru_cache
from typing import Any

import numpy as np
from numba import njit
from numba.core.errors import NumbaError
from numba.np.unsafe.ndarray import to_fixed_tuple

from balance_diagnosis.errors import BalanceError
from balance_diagnosis.model import Predict, Values
from balance_diagnosis.record import Record

Observe = Callable[[Values, Any, Any], Mapping[str, np.ndarray]]


AT, NEXT = (0.0, 0.5, 0.5, 1.0), (0.5, 0.5, 1.0, 0.0)
WEIGHT = (1.0 / 6.0, 1.0 / 3.0, 1.0 / 3.0, 1.0 / 6.0)
"""The stages of a step: where, how far to the next one, and how much each counts."""


def ode(
    rhs: Callable[..., tuple[float, ...]],
    observe: Observe,
    *,
    states: Sequence[str],
    inputs: Sequence[str] = (),
    steps: int = 1,
    held: bool = False,
) -> Predict:
    """Return a prediction for ``Model`` from x' = rhs(x, u, p).

    rhs gets the states and the inputs as tuples, and p with every number as p.NAME; it returns the
    states' derivatives, and has to be what numba compiles: arithmetic, ``math``, ``if``. observe
    (x, record, p) returns channel to (n,), where x has each state as x.NAME, (n,). A state begins
    at the number of its name, at zero where the model has none. inputs: channels. steps: of
    Runge-Kutta from sample to sample. held: inputs keep their value between samples, in place of
    a straight line.
    """
    march = _march(njit(rhs), len(states), steps, held)
    frozen = lru_cache(_frozen)

    def predict(p: Values, record: Record) -> dict[str, np.ndarray]:
        u = np.zeros((len(record), max(len(inputs), 1)))
        for k, channel in enumerate(inputs):
            u[:, k] = record[channel]
        numbers = frozen(tuple(p))(*(float(value) for value in p.values()))
        start = np.array([p.get(name, 0.0) for name in states])
        try:
            made = march(start, u, np.diff(record.times), numbers)
        except NumbaError as error:
            raise BalanceError(f"numba cannot compile '{rhs.__name__}': {_reason(error)}") from None
        x: Any = Values(zip(states, made.T, strict=True))
        found = dict(observe(x, record, p))
        return {**{f"state {name}": x[name] for name in states}, **found}

    predict.states = tuple(states)  # type: ignore[attr-defined]
    return predict


def _reason(error: NumbaError) -> str:
    """Return the line of a compiler's message that says what is wrong, in words of the user."""
    lines = [line.strip() for line in str(error).splitlines() if line.strip()]
    for line in lines:
        unknown = re.search(r"Unknown attribute '(\w+)' of type Numbers", line)
        if unknown:
            return f"there is no '{unknown[1]}' among the model's numbers"
    telling = [line for line in lines if not line.startswith(("Failed in nopython", "File", "-"))]
    return (telling or lines or ["unknown"])[0]


def _frozen(names: tuple[str, ...]) -> Any:
    """Return the kind of tuple that the compiled equations take their numbers from."""
    return namedtuple("Numbers", names)


def _march(rhs: Any, count: int, steps: int, held: bool) -> Any:
    """Return the compiled integration of (states at the start, inputs, periods, p)."""

    @njit
    def slopes(x: Any, u: Any, p: Any, out: Any) -> None:
        found = rhs(to_fixed_tuple(x, count), u, p)
        for i in range(count):
            out[i] = found[i]

    @njit
    def march(start: Any, inputs: Any, periods: Any, p: Any) -> Any:
        n, m = inputs.shape
        path, x, y = np.empty((n, count)), np.empty(count), np.empty(count)
        k, mean, u = np.empty(count), np.empty(count), np.empty(m)
        for i in range(count):  # Loops in place of slices compile in half the time.
            path[0, i] = x[i] = start[i]
        for t in range(n - 1):
            h = periods[t] / steps
            for s in range(steps):
                for i in range(count):
                    mean[i], y[i] = 0.0, x[i]
                for stage in range(4):
                    share = 0.0 if held else (s + AT[stage]) / steps
                    for i in range(m):
                        u[i] = inputs[t, i] + share * (inputs[t + 1, i] - inputs[t, i])
                    slopes(y, u, p, k)
                    for i in range(count):
                        mean[i] += WEIGHT[stage] * k[i]
                        y[i] = x[i] + h * NEXT[stage] * k[i]
                for i in range(count):
                    x[i] += h * mean[i]
            for i in range(count):
                path[t + 1, i] = x[i]
        return path

    return march
