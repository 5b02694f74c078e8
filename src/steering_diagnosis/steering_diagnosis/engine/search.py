"""Forward search with a beam, a pair step, backward elimination and a swap step."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property, partial

import numpy as np

from steering_diagnosis.engine.attempts import Attempts
from steering_diagnosis.engine.evaluate import Call
from steering_diagnosis.engine.evidence import Evidence, HeldOut, critical_ratio, weigh
from steering_diagnosis.engine.failures import NUMERICAL, GivenUpError
from steering_diagnosis.engine.fit import Fit, Problem, misfit, refit, settled
from steering_diagnosis.engine.noise import Noise, mean_square
from steering_diagnosis.engine.parsimony import parsimonious
from steering_diagnosis.engine.screen import Score, pairs, saturated, screen, start_of
from steering_diagnosis.engine.structure import NOISELESS, SCATTER, noiseless
from steering_diagnosis.engine.templates import Template, nuisance_columns

HOPELESS = 0.5
"""Below this share of the family-wise critical ratio a linear gain is not refitted."""
CLOSE, FAR = 0.6, 0.25
"""A hypothesis is refitted only if its linear gain is at least this share of the best; the smaller
share where the model may be far from what it is linear about."""
POLISHED, FINISHED = 4, 0.2
"""Thorough refits of a model at most; and the gain, in critical ratios, after which it is done."""
KEPT = 0.8
"""Share of a linear gain that a refit has to reach, else it is begun elsewhere as well."""
OWN = 0.5
"""Share of a cause's gain that has to be beyond what formulas of larger causes leave of them."""
PAIRS = 3
QUIETER, QUIETER_TIMES = 0.7, 6
"""Share of a noise's root mean square from which another one is so much less that causes show; and
searches in a quieter noise at most."""
VERDICTS = 3
"""Rounds in the noise that the verdict leaves, at most."""
RESTARTS = 8
"""Searches that are begun anew because the best model could not be judged, at most: from then on
the nominal model is the answer."""


@dataclass(repr=False)
class Search(Attempts):
    """State of a search over one record: every model fitted on the way is kept by its causes."""

    problem: Problem
    held: HeldOut
    trials: Sequence[Template]
    start: Fit
    report: Callable[[str], None] = lambda _: None
    fits: dict[frozenset[str], Fit] = field(default_factory=dict)
    screened: dict[frozenset[str], list[Score]] = field(default_factory=dict)
    floor: np.ndarray = field(default_factory=lambda: np.zeros(0))
    failed: dict[frozenset[str], str] = field(default_factory=dict)

    def __post_init__(self) -> None:
        self.critical = critical_ratio(self.problem.settings, len(self.trials))
        self._reduced: set[tuple[frozenset[str], str]] = set()
        self._restarts = 0
        self._first = self.problem
        self._search_in(self._left(self.start), self.start)

    def begin_without(self, error: GivenUpError) -> None:
        """Begin anew, without a model that was the best and cannot be judged."""
        self.give_up(error.names, str(error))
        self._restarts += 1
        self.problem = self._first
        self._search_in(self._left(self.start), self.start)

    @property
    def null(self) -> Fit:
        """The best fit of the nominal model."""
        return self.fits[frozenset()]

    def _judge_in(self, noise: Noise, best: Fit) -> Fit:
        """Judge every model in this noise from now on. Return the best one's fit."""
        null = self.fits.get(frozenset(), self.start)
        self.problem = replace(self.problem, common=noise)
        self.fits.clear()
        self.screened.clear()
        self._reduced.clear()
        with self.judging(best.names):
            self.fit(frozenset(), null.z, {})
            return self.fit(best.names, best.z, dict(best.values))

    @cached_property
    def held_nuisance(self) -> np.ndarray:
        """Return what one standard deviation of each nuisance does to the second record."""
        runs = self.held.runs
        assert runs is not None
        columns = nuisance_columns(runs, self.problem.book, runs.one(Call()))
        return np.where(self.held.valid[..., None], columns, 0.0)

    def weigh(self, without: Fit, full: Fit) -> Evidence:
        """Weigh a model with one more cause."""
        return weigh(self.problem, self.held, without, full, self.floor, len(self.trials))

    def best(self) -> Fit:
        """Return the best model whose every cause is real.

        The search is made in the noise that the whole catalogue would leave, the verdict in that
        which it leaves itself: slow errors would else pass for coloured noise and hide themselves,
        or, where nothing explains them, pass for signal.
        """
        if self._within_resolution() or self._restarts > RESTARTS:
            return self.null
        final = self._found()
        for _ in range(VERDICTS):
            names = final.names
            final = self._judge_in(self.problem.noise(final.residual), final)
            final = self.improve(self._standing(final))
            if final.names == names:
                break
        return final

    def _found(self) -> Fit:
        """Return the model that the search ends with, in the noise that the catalogue leaves.

        That noise is linear about the nominal model. Where a large cause is far from linear, too
        much is left, and all that is smaller hides in it: then the search goes on in the noise
        that the catalogue leaves about the causes that came nearest.
        """
        final = self._searched(self.null)
        for _ in range(QUIETER_TIMES):
            near = self.extended(final, self.problem.settings.refitted_next, FAR)
            with self.judging(final.names):
                left = [self._left(final)]
            left += [n for f in near if (n := self.tried(f.names, partial(self._left, f)))]
            noise = min(left, key=lambda n: float(np.log(n.sd).sum()))
            if not np.any(noise.rms < QUIETER * np.sqrt(self.floor)):
                break
            final = self._searched(self._search_in(noise, final))
        return final

    def _searched(self, begin: Fit) -> Fit:
        """Return the model that a search from another one finds in the present noise."""
        return self._standing(self.improve(self._forward(begin)))

    def _left(self, fit: Fit) -> Noise:
        """Return the noise that the catalogue leaves, linear about a model."""
        return self.problem.noise(saturated(self.problem, fit, self.trials))

    def _search_in(self, noise: Noise, best: Fit) -> Fit:
        """Judge every model in a noise that the catalogue leaves. Return the best one's fit."""
        self.floor = noise.rms**2
        return self._judge_in(noise, best)

    def _within_resolution(self) -> bool:
        """Return whether a record without noise leaves nothing that two solvers would not."""
        runs, p = self.problem.runs, self.problem
        known = runs.own + mean_square(runs.shaken, p.valid)
        left = mean_square(self.null.residual, p.valid)
        return bool(
            np.all(noiseless(known, p.floor) & (left < (NOISELESS * SCATTER * p.floor) ** 2))
        )

    def _standing(self, final: Fit) -> Fit:
        """Return a model without the causes that are not real."""
        while True:
            with self.judging(final.names):
                final = self.polished(final)
                reduced = self._without_weakest(final)
            if reduced is None:
                return final
            final = self.improve(reduced)

    def fit(
        self,
        names: frozenset[str],
        z: np.ndarray,
        values: dict[str, np.ndarray],
        promised: float = np.inf,
    ) -> Fit:
        """Refit a set of causes from a start, keeping the best fit. promised: see ``settled``.

        Raises one of NUMERICAL where no start can be replayed.
        """
        known = self.fits.get(names)
        try:
            found = settled(self.problem, z, values, promised)
        except NUMERICAL:
            if known is None:
                raise
            return known
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
        """Screen what may come next after a fit, once: first what gains most of what it needs."""
        if now.names not in self.screened:
            with self.judging(now.names):
                found = screen(
                    self.problem,
                    now,
                    self.trials,
                    lambda name, work: self.tried(now.names | {name}, work),
                )
            self.screened[now.names] = sorted(found, key=lambda s: -self._worth(s))
        return self.screened[now.names]

    def _worth(self, score: Score) -> float:
        """Return a linear gain over what a clean record may gain by the same hypothesis."""
        return score.gain / self.problem.settings.least_gain_of(score.hypothesis)

    def gains(self, most: int) -> dict[str, float]:
        """Return what single causes gain for each independent sample of an output, the refitted.

        most: so many hypotheses are refitted, those whose linear gain is worth most.
        """
        samples = max(float(self.null.noise.count.max()), 1.0)
        found = self.extended(self.null, most, 0.0)
        return {min(f.names): (self.null.misfit - f.misfit) / samples for f in found}

    def extended(self, now: Fit, most: int, close: float = CLOSE) -> list[Fit]:
        """Return the best one-cause extensions of a fit, refitted.

        close: share of the best linear gain that a hypothesis's own has to reach.
        """
        scores = self.scores(now)
        gain = max((s.gain for s in scores), default=0.0)
        worth = max((self._worth(s) for s in scores), default=0.0)
        found = []
        for i, s in enumerate(scores):
            large = s.gain > close * gain or self._worth(s) > close * worth
            gains = i < most and large and s.gain > HOPELESS * self.critical
            if gains or s.removes:
                names = now.names | {s.hypothesis}
                known = self.fits.get(names) or self.tried(names, partial(self._fit_beyond, now, s))
                found += [known] if known else []
                self.report(s.hypothesis)
        return sorted(found, key=misfit)

    def _fit_beyond(self, now: Fit, start: Score) -> Fit:
        """Fit one more cause from its linear estimate, or from none of it where that leads away."""
        names = now.names | {start.hypothesis}
        h = self.problem.book.hypotheses[start.hypothesis]
        # What has shapes only, a stop or a gap, is far from linear: coloured noise stops it early.
        promised = -np.inf if h.shapes_only else now.misfit - KEPT * start.gain
        found = self.fit(names, start.z, start.values, promised)
        if found.misfit > now.misfit - self.critical:
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
        """Swap step: replace each cause by each of its rivals while that is better or simpler."""
        for _ in range(2):
            options = []
            for name in sorted(final.names):
                with self.judging(final.names):
                    base = self.without(final, name)
                rivals = self.extended(base, self.problem.settings.refitted_next)
                others = [f for f in rivals if f.names != final.names]
                sound = [f for f in others if self.tried(f.names, partial(self._sound, f))]
                first = self._simplest([final, *sound], base)
                options += [first] if first is not final else []
            if not options:
                break
            final = min(options, key=misfit)
        return final

    def _forward(self, begin: Fit) -> Fit:
        beam, final = [begin], begin
        s = self.problem.settings
        for depth in range(len(begin.names), s.most_causes):
            most = s.refitted if depth == 0 else s.refitted_next
            passed = self._passed(beam, most, FAR)
            if depth == 0:
                passed.update({f.names: f for f in self._pairs(passed)})
                # The linear gain of a cause that the noise model has swallowed says little.
                passed = passed or self._passed(beam, s.screened, 0.0)
            if not passed:
                break
            ranked = sorted(passed.values(), key=misfit)
            beam = ranked[: s.beam]
            if final.misfit - ranked[0].misfit < 0.0:
                break
            final = ranked[0]
        return final

    def _simplest(self, fits: Iterable[Fit], base: Fit) -> Fit:
        """Return the simplest of the models that gain as much as the best.

        A difference that is too small for a further cause is the formula's: with a Stribeck speed
        beyond all motion a Stribeck curve is a level, and a little more. base: without the cause.
        """
        ranked = sorted(fits, key=misfit)
        slack = self.problem.settings.equal_gain * max(base.misfit - ranked[0].misfit, 0.0)
        equal = [f for f in ranked if f.misfit <= ranked[0].misfit + slack]
        return min(equal, key=lambda f: sum(len(v) for v in f.values.values()))

    def _passed(self, beam: list[Fit], most: int, close: float) -> dict[frozenset[str], Fit]:
        """Return the extensions of the beam's models whose added cause is real."""
        passed: dict[frozenset[str], Fit] = {}
        for now in beam:
            for full in self.extended(now, most, close):
                known = full.names in passed
                if not known and self.tried(full.names, partial(self._holds, now, full)):
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
        for pair in pairs(self.problem, self.null, self.trials, self.critical, PAIRS):
            both = self.tried(frozenset(pair), partial(self._sound_pair, pair, best))
            found += [both] if both else []
        return found

    def _sound_pair(self, pair: tuple[str, str], best: float) -> Fit | None:
        """Return the fit of a pair, if it is real and may be clearly below the best misfit."""
        now = self.null
        for name in pair:
            options = [t for t in self.trials if t.hypothesis == name]
            starts = [start_of(self.problem, now, t) for t in options]
            start = max(starts, key=lambda s: s.gain)
            if name == pair[1] and now.misfit - start.gain > best - self.critical:
                return None
            now = self.fit(now.names | {name}, start.z, start.values)
        return now if self._sound(now) else None

    def _sound(self, full: Fit) -> bool:
        """Return whether every cause of a model is real given the others."""
        return all(not self.weigh(self.without(full, n), full).why_not for n in sorted(full.names))

    def _without_weakest(self, full: Fit) -> Fit | None:
        """Backward elimination: drop the weakest cause that is not real."""
        found = {n: self.weigh(self.without(full, n), full) for n in sorted(full.names)}
        weak = [
            (e.ratio, n)
            for n, e in found.items()
            if e.why_not or leftover(e, self._leave(found, n))
        ]
        return self.without(full, min(weak)[1]) if weak else None

    def _leave(self, found: Mapping[str, Evidence], name: str) -> list[np.ndarray]:
        """Return what the formulas of larger causes may leave for one, (outputs,) each."""
        s, known = self.problem.settings, self.problem.book.hypotheses
        return [
            e.gains * (s.leaves_near if known[n].balance == known[name].balance else s.leaves)
            for n, e in found.items()
            if not known[n].exact and e.ratio > found[name].ratio
        ]


def leftover(cause: Evidence, left: Sequence[np.ndarray]) -> bool:
    """Return whether a cause fits what the formulas of larger ones leave of them.

    left: gains that each of them may leave, (outputs,). Not more than half of a leftover's gain is
    beyond that.
    """
    gained = np.maximum(cause.gains, 0.0)
    most = np.max([np.zeros_like(gained), *left], axis=0)
    return bool(np.maximum(gained - most, 0.0).sum() < OWN * gained.sum())
