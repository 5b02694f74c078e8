"""The search: forward, delete, swap, pairs; every fit met is kept for the posterior."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator

import numpy as np

from balance_diagnosis.constants import MOST_CAUSES
from balance_diagnosis.evidence import Criterion, Fit
from balance_diagnosis.screen import (
    Score,
    inside,
    scores,
    start_with,
    start_without,
    trials,
)

REFITTED = 4
"""Causes that are refitted after a screening, the best first."""

STEP = 0.1
"""Nats by which the next set has to be better: less is rounding of the fits."""

IDLE = 0.02
"""Deviations from off within which a size does nothing: it starts anew at its typical size."""


class Search:
    """Sets of causes in one criterion. nominal: coordinates of the nominal model, another start."""

    def __init__(self, criterion: Criterion, nominal: np.ndarray) -> None:
        self.criterion, self.problem = criterion, criterion.problem
        self.nominal = nominal
        self.met: dict[frozenset[str], Fit | None] = {}
        self.screened: dict[str, list[Score]] = {}

    def fit(self, names: tuple[str, ...], starts: list[np.ndarray]) -> Fit | None:
        """Return the fit of a set; the first time from the given starts."""
        key = frozenset(names)
        if key not in self.met:
            self.met[key] = self.criterion.fit(names, starts)
        return self.met[key]

    def climb(self, start: Fit) -> Fit:
        """Return the best set that single steps lead to."""
        current = start
        while True:
            better = max(self._steps(current), key=lambda f: f.evidence, default=None)
            if better is None or better.evidence < current.evidence + STEP:
                return current
            current = better

    def around(self, best: Fit) -> None:
        """Meet the neighbours of the best set: one cause more, one less, one in another's place."""
        self._grown(best, every=True)
        for cause in best.names:
            self._less(best, cause)
            self._swapped(best, cause)

    def _steps(self, current: Fit) -> list[Fit]:
        """Return neighbours; further ones are met only where nearer ones gain nothing."""
        met: list[Fit] = []
        neighbours: tuple[Callable[[], Iterable[Fit | None]], ...] = (
            lambda: self._grown(current),
            lambda: (self._less(current, cause) for cause in current.names),
            lambda: (f for cause in current.names for f in self._swapped(current, cause)),
            lambda: self._pairs(current, list(met)),
        )
        for nearer in neighbours:
            met += [fit for fit in nearer() if fit is not None]
            if any(fit.evidence >= current.evidence + STEP for fit in met):
                break
        return met

    def _grown(self, current: Fit, every: bool = False, most: int = REFITTED) -> list[Fit]:
        """Return fits with one more cause. every: keep the screening for the verdict."""
        if len(current.names) >= MOST_CAUSES:
            return []
        rest = [cause for cause in self.problem.model.causes if cause not in current.names]
        screened = scores(self.criterion, current, trials(self.problem, current, rest))
        if every:
            self.screened = screened
        ranked = sorted(screened, key=lambda cause: -screened[cause][0].gain)
        top = screened[ranked[0]][0].gain if ranked else 0.0
        found = []
        for place, cause in enumerate(ranked):
            far = not self.problem.probed[cause].linear and screened[cause][0].gain > 0.3 * top
            if place < most or far or not current.names:
                found.append(self._added(current, cause, screened[cause]))
        return [fit for fit in found if fit is not None]

    def _added(self, current: Fit, cause: str, known: list[Score]) -> Fit | None:
        """Return the refit with one more cause: from here, and from the nominal model.

        A cause that is not linear begins at each of its sizes, beside its best shape there.
        """
        sizes = self.problem.probed[cause].sizes
        begun: dict[tuple[float, ...], Score] = {}
        for score in known if not self.problem.probed[cause].linear else known[:1]:
            begun.setdefault(tuple(score.numbers[size] for size in sizes), score)
        starts = []
        for score in begun.values():
            names, here = start_with(self.problem, current, cause, score.numbers, score.factor)
            _, fresh = start_with(self.problem, current, cause, score.numbers)
            fresh = np.r_[self.nominal, fresh[len(self.nominal) :]]
            starts += [here, inside(self.problem, names, fresh)]
        return self.fit((*current.names, cause), starts)

    def _less(self, current: Fit, cause: str) -> Fit | None:
        names, here = start_without(self.problem, current, cause)
        return self.fit(names, self._restarts(names, here))

    def _swapped(self, current: Fit, cause: str) -> list[Fit]:
        lean = self._less(current, cause)
        return [] if lean is None else self._grown(lean, most=REFITTED // 2)

    def _pairs(self, current: Fit, met: list[Fit]) -> Iterator[Fit]:
        """Yield fits with two more causes: the second may help only beside the first."""
        grown = [fit for fit in met if len(fit.names) == len(current.names) + 1]
        for first in sorted(grown, key=lambda fit: -fit.evidence)[:2]:
            yield from self._grown(first, most=REFITTED // 2)

    def _restarts(self, names: tuple[str, ...], here: np.ndarray) -> list[np.ndarray]:
        """Return starts of a set: here, nominal with typical sizes, and idle sizes woken."""
        common = len(self.nominal)
        slots = self.problem.slots(names)
        typical = here.copy()
        for i, slot in enumerate(slots[common:], common):
            start = self.problem.probed[slot.cause].start[slot.name]
            typical[i] = slot.prior.place(start)
        idle = [
            i >= common
            and abs(here[i]) < IDLE
            and slot.name in self.problem.probed[slot.cause].sizes
            for i, slot in enumerate(slots)
        ]
        fresh = np.r_[self.nominal, typical[common:]]
        starts = [here, fresh]
        if any(idle):
            starts.append(np.where(idle, typical, here))
        return [here, *(inside(self.problem, names, x) for x in starts[1:])]
