"""What a hypothesis does to the residual: secants at its typical size, shapes scanned on a grid."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from steering_diagnosis.engine.catalogue import Catalogue, Values, scale
from steering_diagnosis.engine.evaluate import Call, Evaluator, Failed
from steering_diagnosis.engine.model import Hypothesis

DIVERGES = 1e6
"""Change by a visible size over what most hypotheses change, and over the nominal error, from which
the model diverges: a number that is none."""
FAR = (4.0, 5.0, 6.0)
"""Further steps, in typical sizes, of a hypothesis that has shapes only."""


@dataclass(frozen=True, eq=False)
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
    """Return the change of the residual per standard deviation of each nuisance, (n, m, p).

    Zeros where the model cannot be replayed a step away: such a nuisance stays where it is.
    """
    none = np.zeros(len(book.nuisances))
    found = secants(runs, book, none, {}, range(len(none)), 1.0)
    columns = np.zeros((*base.shape, len(none)))
    for i, (moved, step) in found.items():
        columns[..., i] = (moved - base) / step
    return columns


def secants(
    runs: Evaluator,
    book: Catalogue,
    z: np.ndarray,
    values: Values,
    chosen: Sequence[int],
    size: float,
) -> dict[int, tuple[np.ndarray, float]]:
    """Return residuals, (n, m), a step away in the chosen nuisances, and the steps, by position.

    size: of the steps [standard deviations]; the other way where that leaves the physical range or
    cannot be replayed. A nuisance that can be stepped neither way is left out.
    """

    def moved(i: int, step: float) -> Call:
        away = z.copy()
        away[i] += step
        return book.call(away, values)

    steps = {i: book.step(z, i, size) for i in chosen}
    answers = runs.answers([moved(i, step) for i, step in steps.items()])
    found = {}
    for (i, step), answer in zip(steps.items(), answers, strict=True):
        if isinstance(answer, Failed):
            step = book.step(z, i, -step)
            answer = runs.answers([moved(i, step)])[0]
        if not isinstance(answer, Failed) and step != 0.0:
            found[i] = answer, step
    return found


def templates(
    runs: Evaluator,
    book: Catalogue,
    base: np.ndarray,
    nuisance: np.ndarray,
    grid: Sequence[float],
) -> tuple[list[Template], dict[str, str]]:
    """Return the templates of the whole catalogue about the nominal model.

    And why hypotheses have none: no step of theirs can be replayed, or all of them diverge.
    """
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
    answers = iter(runs.answers(calls))
    found: list[Template] = []
    failed: dict[str, str] = {}
    for h, start, free, unit in steps:
        given = [next(answers) for _ in free]
        why = next((a.why for a in given if isinstance(a, Failed)), None)
        if why is not None:
            failed[h.name] = why
            continue
        columns = np.stack([a - base for a in given if not isinstance(a, Failed)], axis=-1)
        made = Template(h.name, start, free, unit, columns, *_spoken_for(h, unit, grid))
        if not (found and _backwards(h, made) and _mirrored(found[-1], made)):
            found.append(made)
    for h in book.hypotheses.values():
        name = book.nuisance_of(h.name)
        if name is not None:
            i = book.index[name]
            unit = np.array([scale(h.parameters[0])])
            columns = nuisance[:, :, [i]] * (unit[0] / book.deviation[i])
            found.append(
                Template(h.name, np.array([h.parameters[0].neutral], float), (0,), unit, columns)
            )
    kept = _measurable(found, base)
    failed |= {t.hypothesis: "its error grows beyond all measure" for t in found if t not in kept}
    known = {t.hypothesis for t in kept}
    return kept, {name: why for name, why in failed.items() if name not in known}


def _measurable(found: Sequence[Template], base: np.ndarray) -> list[Template]:
    """Return the templates that do not diverge: beside one, the others' equations are no more."""
    sizes = [np.sqrt(np.nanmean(t.columns**2, axis=(0, 2))) for t in found]
    usual = np.sqrt(np.nanmean(base**2, axis=0))
    if sizes:
        usual = np.maximum(usual, np.median(sizes, axis=0))
    most = np.where(usual > 0.0, DIVERGES * usual, np.inf)
    return [t for t, s in zip(found, sizes, strict=True) if np.all(s <= most)]


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


def _backwards(h: Hypothesis, t: Template) -> bool:
    """Return whether a template's step goes against the typical one."""
    p = h.parameters[t.free[0]]
    return bool(t.unit[0] * (p.typical - p.neutral) < 0.0)


def _mirrored(there: Template, back: Template) -> bool:
    """Return whether the other way round is the same with the sign changed, to a tenth."""
    if there.hypothesis != back.hypothesis or not np.array_equal(there.unit, -back.unit):
        return False
    one, other = there.columns, back.columns
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
