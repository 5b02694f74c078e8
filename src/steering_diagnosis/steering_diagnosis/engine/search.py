"""Forward search with a beam, a pair step, backward elimination and a swap step."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass, field
from functools import cached_property

import numpy as np

from steering_diagnosis.engine.ambiguity import ahead
from steering_diagnosis.engine.evaluate import Call
from steering_diagnosis.engine.evidence import Evidence, HeldOut, critical_ratio, weigh
from steering_diagnosis.engine.fit import SMALL, Fit, Problem, gauss_newton, misfit, refit, settled
from steering_diagnosis.engine.parsimony import parsimonious
from steering_diagnosis.engine.screen import Score, pairs, saturated, screen, start_of
from steering_diagnosis.engine.templates import Template, nuisance_columns

HOPELESS = 0.5
"""Below this share of the family-wise critical ratio a linear gain is not refitted."""
CLOSE, FAR = 0.6, 0.25
"""A hypothesis is refitted only if its linear gain is at least this share of the best; the smaller
share where the model may be far from what it is linear about."""
POLISHED, FINISHED = 4, 0.2
"""Thorough refits of a model at most; and the gain, in critical ratios, after which it is done."""
PAIRS = 3
RESTARTS = 3


@dataclass(repr=False)
class Search:
    """State of a search over one record: every model fitted on the way is kept by its causes."""

    problem: Problem
    held: HeldOut
    trials: Sequence[Template]
    null: Fit
    report: Callable[[str], None] = lambda _: None
    fits: dict[frozenset[str], Fit] = field(default_factory=dict)
    screened: dict[frozenset[str], list[Score]] = field(default_factory=dict)
    floor: np.ndarray = field(default_factory=lambda: np.zeros(0))

    def __post_init__(self) -> None:
        self.fits[frozenset()] = self.null
        residual = saturated(self.problem, self.null, self.trials)
        self._noise = self.problem.noise(residual)
        self.floor = self._noise.rms**2
        self._other_start()
        p = self.problem.settings.family_p
        self.critical = critical_ratio(p, len(self.trials))
        self._reduced: set[tuple[frozenset[str], str]] = set()

    def _other_start(self) -> None:
        """Refit the nominal model from the noise that the whole catalogue would leave as well."""
        null = self.null = self.fits[frozenset()] = settled(
            self.problem, self.null.z, {}, self.floor
        )
        for noise in (self._noise, self._noise.white):
            state = Fit(null.z, {}, null.residual, noise, null.misfit)
            step, _, _ = gauss_newton(self.problem, state, {}, self.problem.nuisance)
            other = refit(self.problem, null.z + step, {})
            if other.misfit < self.null.misfit:
                self.null = self.fits[frozenset()] = other

    @cached_property
    def held_nuisance(self) -> np.ndarray:
        """Return what one standard deviation of each nuisance does to the second record."""
        runs = self.held.runs
        assert runs is not None
        columns = nuisance_columns(runs, self.problem.book, runs.one(Call()))
        return np.where(self.held.valid[..., None], columns, 0.0)

    def weigh(self, without: Fit, full: Fit) -> Evidence:
        """Weigh a model with one more cause."""
        whole = self.null.misfit - full.misfit
        return weigh(self.problem, self.held, without, full, self.floor, len(self.trials), whole)

    def best(self) -> Fit:
        """Return the best model whose every cause is real.

        A nominal model that fits better than when the search began, found on the way back from
        some cause, begins it anew: against a poor one anything looks like a cause.
        """
        for _ in range(RESTARTS):
            final = self._once()
            null = self.fits[frozenset()]
            if null.misfit > self.null.misfit - SMALL:
                break
            self.null, self.fits = null, {frozenset(): null}
            self.screened.clear()
            self._reduced.clear()
        return final

    def _once(self) -> Fit:
        final = self.improve(self._forward())
        while True:
            final = self.polished(final)
            reduced = self._without_weakest(final)
            if reduced is None:
                return final
            final = self.improve(reduced)

    def fit(self, names: frozenset[str], z: np.ndarray, values: dict[str, np.ndarray]) -> Fit:
        """Refit a set of causes from a start, keeping the better of two fits."""
        found = settled(self.problem, z, values, self.floor)
        known = self.fits.get(names)
        if known is None or found.misfit < known.misfit:
            self.fits[names] = found
        return self.fits[names]

    def polished(self, best: Fit) -> Fit:
        """Return the best model with all columns renewed and without sizes that add nothing."""
        if best.values:
            for _ in range(POLISHED):
                found = refit(self.problem, best.z, best.values, thorough=True)
                gained, best = best.misfit - found.misfit, min(found, best, key=misfit)
                if gained < FINISHED * self.critical:
                    break
            self.problem, best = parsimonious(self.problem, best)
            self.fits[best.names] = best
        return best

    def scores(self, now: Fit) -> list[Score]:
        """Screen what may come next after a fit, once."""
        if now.names not in self.screened:
            noises = [now.noise, self._noise, self._noise.white]
            self.screened[now.names] = screen(self.problem, now, self.trials, noises)
        return self.screened[now.names]

    def extended(self, now: Fit, most: int, close: float = CLOSE) -> list[Fit]:
        """Return the best one-cause extensions of a fit, refitted.

        close: share of the best linear gain that a hypothesis's own has to reach.
        """
        scores = self.scores(now)
        if not scores:
            return []
        least = max(close * scores[0].gain, HOPELESS * self.critical)
        found = []
        for s in scores[:most]:
            if s.gain < least:
                break
            names = now.names | {s.hypothesis}
            found.append(self.fits.get(names) or self._fit_beyond(now, s))
            self.report(s.hypothesis)
        return sorted(found, key=misfit)

    def _fit_beyond(self, now: Fit, start: Score) -> Fit:
        """Fit one more cause from its linear estimate, or from none of it where that leads away."""
        names = now.names | {start.hypothesis}
        found = self.fit(names, start.z, start.values)
        if found.misfit > now.misfit - self.critical:
            h = self.problem.book.hypotheses[start.hypothesis]
            shapes = zip(h.parameters, start.values[h.name], strict=True)
            none = np.array([v if p.shape else p.neutral for p, v in shapes])
            if not np.array_equal(none, start.values[h.name]):
                found = self.fit(names, now.z, {**now.values, h.name: none})
        return found

    def without(self, full: Fit, name: str) -> Fit:
        """Return the model without one of its causes, refitted."""
        names, origin = full.names - {name}, (full.names, name)
        if origin not in self._reduced:
            # From the full model too: a rival stuck in a poor optimum would be no rival.
            self._reduced.add(origin)
            values = {n: v for n, v in full.values.items() if n != name}
            self.fit(names, full.z, values)
        return self.fits[names]

    def improve(self, final: Fit) -> Fit:
        """Swap step: replace each cause by each of its rivals while that is better."""
        for _ in range(2):
            options = [final]
            for name in sorted(final.names) if len(final.names) > 1 else []:
                base = self.without(final, name)
                options += [f for f in self.extended(base, 3) if self._sound(f)]
            best = min(options, key=misfit)
            if best is final:
                break
            final = best
        return final

    def _forward(self) -> Fit:
        beam, final = [self.null], self.null
        s = self.problem.settings
        for depth in range(s.most_causes):
            most = s.refitted if depth == 0 else 3
            passed = self._passed(beam, most, FAR)
            if depth == 0:
                passed.update({f.names: f for f in self._pairs(passed)})
                # The linear gain of a cause that the noise model has swallowed says little.
                passed = passed or self._passed(beam, s.screened, 0.0)
            if not passed:
                break
            ranked = self._ranked(passed.values())
            beam = ranked[: s.beam]
            if final.misfit - ranked[0].misfit < 0.0:
                break
            final = ranked[0]
        return final

    def _ranked(self, fits: Iterable[Fit]) -> list[Fit]:
        """Return models by misfit, but first one that beats the best in the noise of either.

        Of two, one may owe its misfit to coloured noise that takes up the slow error it leaves.
        """
        ranked = sorted(fits, key=misfit)
        for fit in ranked[1:]:
            if ahead(self.problem, fit, ranked[0]) > self.critical:
                ranked = [fit, *(other for other in ranked if other is not fit)]
        return ranked

    def _passed(self, beam: list[Fit], most: int, close: float) -> dict[frozenset[str], Fit]:
        """Return the extensions of the beam's models whose added cause is real."""
        passed: dict[frozenset[str], Fit] = {}
        for now in beam:
            for full in self.extended(now, most, close):
                if full.names not in passed and self._holds(now, full):
                    passed[full.names] = full
        return passed

    def _holds(self, now: Fit, full: Fit) -> bool:
        """Return whether the added cause is real, also against the model refitted without it."""
        if self.weigh(now, full).why_not:
            return False
        (added,) = full.names - now.names
        return not self.weigh(self.without(full, added), full).why_not

    def _pairs(self, singles: dict[frozenset[str], Fit]) -> list[Fit]:
        """Return pairs that are real although neither of the two need be real alone."""
        best = min((f.misfit for f in singles.values()), default=self.null.misfit)
        found = []
        for a, b in pairs(self.problem, self.null, self.trials, self._noise, self.critical, PAIRS):
            now = self.null
            for name in (a, b):
                options = [t for t in self.trials if t.hypothesis == name]
                starts = [start_of(self.problem, now, t) for t in options]
                start = max(starts, key=lambda s: s.gain)
                if name == b and now.misfit - start.gain > best - self.critical:
                    break
                now = self.fit(now.names | {name}, start.z, start.values)
            if now.names == frozenset((a, b)) and self._sound(now):
                found.append(now)
        return found

    def _exact(self, name: str) -> bool:
        return self.problem.book.hypotheses[name].exact

    def _sound(self, full: Fit) -> bool:
        """Return whether every cause of a model is real given the others."""
        return all(not self.weigh(self.without(full, n), full).why_not for n in sorted(full.names))

    def _without_weakest(self, full: Fit) -> Fit | None:
        """Backward elimination: drop the weakest cause that is not real."""
        found = {n: self.weigh(self.without(full, n), full) for n in sorted(full.names)}
        # Another formula than ours leaves a little of a large cause, which some other one fits.
        inexact = [e.ratio for n, e in found.items() if not self._exact(n)]
        least = self.problem.settings.least_next * max(inexact, default=0.0)
        weak = [(e.ratio, n) for n, e in found.items() if e.why_not or e.ratio < least]
        return self.without(full, min(weak)[1]) if weak else None
