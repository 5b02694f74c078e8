"""What is said: the posterior over all sets met, and the words that follow from it."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

from balance_diagnosis.check import not_noise, predicted_share
from balance_diagnosis.evidence import Fit
from balance_diagnosis.noise import Scenery
from balance_diagnosis.search import Search

NAMED, AMBIGUOUS, PROBABLE = "named", "ambiguous", "probable"
CLEAN, CANNOT_TELL, UNEXPLAINED = "clean", "cannot tell", "unexplained"

LEAST_MEMBER = 0.02
"""Probability of a rival that belongs into a group."""


@dataclass(frozen=True)
class Verdict:
    """The answer and its reasons.

    named: sure causes. groups: one of each is sure. candidates: of the best set, where the error is
    unexplained. probability: of each cause. none: of no cause at all. left: share of the nominal
    error that the best set leaves; predictable: of that, by smooth functions, in blocks left out.
    cannot_see: causes that typical sizes would not show, with their expected information [nats].
    refused: why each other cause is not named.
    """

    word: str
    named: tuple[str, ...]
    groups: tuple[tuple[str, ...], ...]
    candidates: tuple[str, ...]
    probability: dict[str, float]
    none: float
    left: float
    predictable: float
    cannot_see: dict[str, float] = field(default_factory=dict)
    refused: dict[str, str] = field(default_factory=dict)


class Posterior:
    """Probabilities over the sets met. A cause that no refit has gets what it can have at most."""

    def __init__(self, search: Search, best: Fit) -> None:
        self.search, self.best = search, best
        self.fits = [fit for fit in search.met.values() if fit is not None]
        self.causes = list(search.problem.model.causes)
        top = best.evidence
        self.weights = np.exp(np.array([fit.evidence - top for fit in self.fits]).clip(max=500.0))
        met = {cause for fit in self.fits for cause in fit.names}
        self.unmet = {c: self._bounded(c) for c in self.causes if c not in met}
        self.total = float(self.weights.sum() + sum(self.unmet.values()))

    def any_of(self, *causes: str) -> float:
        """Return the probability that at least one of some causes is there."""
        have = [any(c in fit.names for c in causes) for fit in self.fits]
        more = [
            w for c, w in self.unmet.items() if c in causes or set(causes) & set(self.best.names)
        ]
        return float((self.weights[have].sum() + sum(more)) / self.total)

    def none(self) -> float:
        """Return the probability that there is no cause."""
        empty = [not fit.names for fit in self.fits]
        return float(self.weights[empty].sum() / self.total)

    def _bounded(self, cause: str) -> float:
        """Return the weight of the best set with a cause that screening did not ask for."""
        known = self.search.screened.get(cause)
        if not known:
            return 0.0
        score, constants = known[0], self.search.problem.constants
        prior = self.search.criterion.prior
        occam = 0.5 * np.log1p(2.0 * score.information * constants.slab**2)
        return float(np.exp(max(score.gain, 0.0) - occam + np.log(prior / (1.0 - prior))))


def decide(search: Search, best: Fit, nominal: Fit, scenery: Scenery) -> Verdict:
    """Return the verdict. nominal: the model without a cause and without spikes."""
    constants = search.problem.constants
    posterior = Posterior(search, best)
    probability = {cause: posterior.any_of(cause) for cause in posterior.causes}
    named = tuple(c for c in best.names if probability[c] >= constants.sure)
    groups = _groups(posterior, [c for c in best.names if c not in named], constants.sure)
    error = float(nominal.excess.sum())
    left = float(best.excess.sum()) / error if error > 0.0 else 0.0
    predictable = predicted_share(search.criterion, scenery, best)
    none = posterior.none()
    hidden = {
        score.cause: score.information
        for known in search.screened.values()
        for score in known
        if score.numbers == search.problem.probed[score.cause].start
        and score.information < constants.visible
    }
    incomplete = not_noise(search.criterion, best) >= constants.sure
    if incomplete and left * predictable >= constants.material:
        word = UNEXPLAINED
    elif named and not groups:
        word = NAMED
    elif named or groups:
        word = AMBIGUOUS if groups else NAMED
    elif best.names:
        word = PROBABLE
    else:
        word = CANNOT_TELL if hidden or none < 0.5 else CLEAN
    silent = word == UNEXPLAINED
    verdict = Verdict(
        word,
        () if silent else named,
        () if silent else groups,
        best.names if silent else (),
        probability,
        none,
        left,
        predictable,
        hidden,
    )
    return Verdict(**{**verdict.__dict__, "refused": _refused(verdict, search, best)})


def _groups(posterior: Posterior, unsure: list[str], sure: float) -> tuple[tuple[str, ...], ...]:
    """Return, for each cause that is not sure alone, the rivals with which it is."""
    made = []
    rivals = sorted(
        (c for c in posterior.causes if c not in posterior.best.names),
        key=lambda c: -posterior.any_of(c),
    )
    for cause in unsure:
        group = [cause]
        for rival in rivals:
            if posterior.any_of(rival) < LEAST_MEMBER:
                break
            group.append(rival)
            if posterior.any_of(*group) >= sure:
                made.append(tuple(group))
                break
    return tuple(made)


def _refused(verdict: Verdict, search: Search, best: Fit) -> dict[str, str]:
    """Return the true reason why each cause that is not named is not."""
    said = {*verdict.named, *(c for group in verdict.groups for c in group)}
    reasons = {}
    for cause in search.problem.model.causes:
        if cause in said:
            continue
        if verdict.word == UNEXPLAINED and cause in best.names:
            reasons[cause] = (
                f"in the best set, but that leaves {verdict.left:.0%} of the error, of which "
                f"{verdict.predictable:.0%} has a form that no cause has"
            )
            continue
        if cause in best.names:
            reasons[cause] = f"probable only: {verdict.probability[cause]:.2f}"
            continue
        fits = [fit for fit in search.met.values() if fit is not None and cause in fit.names]
        if not fits:
            known = search.screened.get(cause)
            gain = f"gains {max(known[0].gain, 0.0):.1f} nats at most" if known else "cannot be run"
            reasons[cause] = f"{gain} beside the best set; not refitted"
            continue
        nearest = max(fits, key=lambda fit: fit.evidence)
        worse = best.evidence - nearest.evidence
        bound = sorted(set(nearest.at_bound) & set(search.problem.probed[cause].priors))
        where = f"; {', '.join(bound)} stands at its bound" if bound else ""
        reasons[cause] = f"fits worse by {worse:.1f} nats{where}"
    return reasons
