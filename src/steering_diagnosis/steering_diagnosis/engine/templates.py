"""What a hypothesis does to the residual: secants at its typical size, shapes scanned on a grid."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from steering_diagnosis.engine.catalogue import Catalogue, scale
from steering_diagnosis.engine.evaluate import Evaluator
from steering_diagnosis.engine.model import Hypothesis

FAR = (4.0, 5.0, 6.0)
"""Further steps, in typical sizes, of a hypothesis that has shapes only."""


@dataclass(frozen=True)
class Template:
    """One trial of a hypothesis: residual changes linearly with the free parameters.

    start: parameter values that the columns start from (free ones neutral), (k,). free: their
    positions. unit: step of each column. columns: (n, outputs, len(free)). least, most: how many
    steps the columns speak for.
    """

    hypothesis: str
    start: np.ndarray
    free: tuple[int, ...]
    unit: np.ndarray
    columns: np.ndarray
    least: float = -np.inf
    most: float = np.inf

    def values(self, u: np.ndarray) -> np.ndarray:
        """Return the parameters at the free coordinates ``u``."""
        value = self.start.copy()
        value[list(self.free)] += u * self.unit
        return value


def nuisance_columns(runs: Evaluator, book: Catalogue, base: np.ndarray) -> np.ndarray:
    """Return the change of the residual per standard deviation of each nuisance, (n, m, p)."""
    unit = np.eye(len(book.nuisances))
    calls = [book.call(unit[i], {}) for i in range(len(book.nuisances))]
    if not calls:
        return np.zeros((*base.shape, 0))
    return np.stack([r - base for r in runs.many(calls)], axis=-1)


def templates(
    runs: Evaluator,
    book: Catalogue,
    base: np.ndarray,
    nuisance: np.ndarray,
    grid: Sequence[float],
) -> list[Template]:
    """Return the templates of the whole catalogue about the nominal model."""
    trials = [
        (h, start, free)
        for h in book.hypotheses.values()
        if book.nuisance_of(h.name) is None
        for start, free in _trials(h, grid)
    ]
    steps = [
        (h, start, free, sign * unit)
        for h, start, free in trials
        for unit in _units(h, free, grid)
        for sign in (1.0, -1.0)
        if sign > 0.0 or _signed(h, start, free, unit)
    ]
    none = np.zeros(len(book.nuisances))
    calls = []
    for h, start, free, unit in steps:
        for i, step in zip(free, unit, strict=True):
            value = start.copy()
            value[i] += step
            calls.append(book.call(none, {h.name: value}))
    answers = iter(runs.many(calls))
    found: list[Template] = []
    for h, start, free, unit in steps:
        columns = np.stack([next(answers) - base for _ in free], axis=-1)
        backwards = unit[0] * (h.parameters[free[0]].typical - h.parameters[free[0]].neutral) < 0.0
        if not backwards or not _mirrors(found[-1].columns, columns):
            found.append(Template(h.name, start, free, unit, columns, *_spoken_for(h, unit, grid)))
    for h in book.hypotheses.values():
        name = book.nuisance_of(h.name)
        if name is not None:
            i = book.index[name]
            unit = np.array([scale(h.parameters[0])])
            columns = nuisance[:, :, [i]] * (unit[0] / book.deviation[i])
            found.append(
                Template(h.name, np.array([h.parameters[0].neutral], float), (0,), unit, columns)
            )
    return found


def _units(h: Hypothesis, free: tuple[int, ...], grid: Sequence[float]) -> list[np.ndarray]:
    """Return the steps of a trial: typical sizes, and where all are shapes more of them.

    A gap, a stop or a delay moves nothing until it is reached, and is far from linear then.
    """
    typical = np.array([h.parameters[i].typical - h.parameters[i].neutral for i in free])
    if not h.shapes_only:
        return [typical]
    room = np.array([h.parameters[i].high - h.parameters[i].neutral for i in free])
    return [np.minimum(factor * typical, 0.9 * room) for factor in (*grid, *FAR)]


def _spoken_for(h: Hypothesis, unit: np.ndarray, grid: Sequence[float]) -> tuple[float, float]:
    """Return how many of its steps a template's columns speak for, at least and at most.

    Of shapes alone for none but itself; the smallest step for smaller ones too.
    """
    if not h.shapes_only:
        return -np.inf, np.inf
    smallest = min(grid) * scale(h.parameters[0]) * (1.0 + 1e-9)
    return (0.0 if abs(unit[0]) <= smallest else 1.0), 1.0


def _signed(h: Hypothesis, start: np.ndarray, free: tuple[int, ...], unit: np.ndarray) -> bool:
    """Return whether a step may also be taken the other way."""
    back = start[list(free)] - unit
    low = np.array([h.parameters[i].low for i in free])
    high = np.array([h.parameters[i].high for i in free])
    return bool(np.all((back >= low) & (back <= high)))


def _mirrors(one: np.ndarray, other: np.ndarray) -> bool:
    """Return whether the other way round is the same with the sign changed, to a tenth."""
    known = np.isfinite(one) & np.isfinite(other)
    size = np.sum(one[known] ** 2) + np.sum(other[known] ** 2)
    return bool(np.sum((one + other)[known] ** 2) < 0.02 * size)


def _trials(h: Hypothesis, grid: Sequence[float]) -> list[tuple[np.ndarray, tuple[int, ...]]]:
    """Return starting values and free positions: one shape at a time leaves its typical value."""
    shapes = [i for i, p in enumerate(h.parameters) if p.shape]
    free = tuple(i for i in range(len(h.parameters)) if i not in shapes)
    if not free:
        free, shapes = tuple(range(len(h.parameters))), []
    values = [p.typical if i in shapes else p.neutral for i, p in enumerate(h.parameters)]
    start = np.array(values, float)
    found = [start]
    for i in shapes:
        p = h.parameters[i]
        for factor in grid:
            value = start.copy()
            value[i] = np.clip(factor * p.typical, p.low, p.high)
            if not any(np.allclose(value, other) for other in found):
                found.append(value)
    return [(value, free) for value in found]
