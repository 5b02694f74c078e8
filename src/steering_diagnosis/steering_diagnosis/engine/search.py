"""Forward search with a beam, a pair step, backward elimination and a swap step."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field

import numpy as np

from steering_diagnosis.engine.evidence import Evidence, HeldOut, critical_ratio, weigh
from steering_diagnosis.engine.fit import SMALL, Fit, Problem, gauss_newton, refit
from steering_diagnosis.engine.screen import Score, pairs, saturated, screen, start_of
from steering_diagnosis.engine.templates import Template

HOPELESS = 0.5
"""Below this share of the family-wise critical ratio a linear gain is not refitted."""
CLOSE = 0.6
"""A hypothesis is refitted only if its linear gain is at least this share of the best."""
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
        self._other_start()
        p = self.problem.settings.family_p
        self.critical = critical_ratio(p, len(self.trials))
        self._reduced: set[tuple[frozenset[str], str]] = set()
        self.floor = self._noise.rms**2

    def _other_start(self) -> None:
        """Refit the nominal model from the noise that the whole catalogue would leave as well."""
        null = self.null
        for noise in (self._noise, self._noise.white):
            state = Fit(null.z, {}, null.residual, noise, null.misfit)
            step, _, _ = gauss_newton(self.problem, state, {}, self.problem.nuisance)
            other = refit(self.problem, null.z + step, {})
            if other.misfit < self.null.misfit:
                self.null = self.fits[frozenset()] = other

    def weigh(self, without: Fit, full: Fit) -> Evidence:
        """Weigh a model with one more cause."""
        return weigh(self.problem, self.held, without, full, self.floor, len(self.trials))

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
            reduced = self._without_weakest(final)
            if reduced is None:
                return final
            final = self.improve(reduced)

    def fit(self, names: frozenset[str], z: np.ndarray, values: dict[str, np.ndarray]) -> Fit:
        """Refit a set of causes from a start, keeping the better of two fits."""
        found = refit(self.problem, z, values)
        known = self.fits.get(names)
        if known is None or found.misfit < known.misfit:
            self.fits[names] = found
        return self.fits[names]

    def scores(self, now: Fit) -> list[Score]:
        """Screen what may come next after a fit, once."""
        if now.names not in self.screened:
            noises = [now.noise, self._noise, self._noise.white]
            self.screened[now.names] = screen(self.problem, now, self.trials, noises)
        return self.screened[now.names]

    def extended(self, now: Fit, most: int) -> list[Fit]:
        """Return the best one-cause extensions of a fit, refitted."""
        scores = self.scores(now)
        if not scores:
            return []
        least = max(CLOSE * scores[0].gain, HOPELESS * self.critical)
        found = []
        for s in scores[:most]:
            if s.gain < least:
                break
            names = now.names | {s.hypothesis}
            known = self.fits.get(names)
            found.append(known or self.fit(names, s.z, s.values))
            self.report(s.hypothesis)
        return sorted(found, key=lambda f: f.misfit)

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
            best = min(options, key=lambda f: f.misfit)
            if best is final:
                break
            final = best
        return final

    def _forward(self) -> Fit:
        beam, final = [self.null], self.null
        s = self.problem.settings
        for depth in range(s.most_causes):
            passed: dict[frozenset[str], Fit] = {}
            for now in beam:
                for full in self.extended(now, s.refitted if depth == 0 else 3):
                    if full.names not in passed and self._holds(now, full):
                        passed[full.names] = full
            if depth == 0:
                passed.update({f.names: f for f in self._pairs(passed)})
            if not passed:
                break
            ranked = sorted(passed.values(), key=lambda f: f.misfit)
            beam = ranked[: s.beam]
            if final.misfit - ranked[0].misfit < 0.0:
                break
            final = ranked[0]
        return final

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

    def _sound(self, full: Fit) -> bool:
        """Return whether every cause of a model is real given the others."""
        return all(not self.weigh(self.without(full, n), full).why_not for n in sorted(full.names))

    def _without_weakest(self, full: Fit) -> Fit | None:
        """Backward elimination: drop the weakest cause that is not real."""
        found = {n: self.weigh(self.without(full, n), full) for n in sorted(full.names)}
        largest = max((evidence.ratio for evidence in found.values()), default=0.0)
        # Another formula than ours leaves a little of a large cause, which some other one fits.
        least = self.problem.settings.least_next * largest
        weak = [(e.ratio, n) for n, e in found.items() if e.why_not or e.ratio < least]
        return self.without(full, min(weak)[1]) if weak else None
