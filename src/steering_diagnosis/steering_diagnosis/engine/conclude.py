"""From the best model to the answer: causes, ambiguity, what remains, and why rivals lost."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from functools import partial

import numpy as np

from steering_diagnosis.engine.agreement import records_apart
from steering_diagnosis.engine.ambiguity import Comparison, as_good, compare
from steering_diagnosis.engine.ends import pressed
from steering_diagnosis.engine.evidence import Evidence, HeldOut
from steering_diagnosis.engine.findings import Findings, Loser, NamedCause, Region, Rms
from steering_diagnosis.engine.fit import Fit
from steering_diagnosis.engine.intervals import intervals, posterior
from steering_diagnosis.engine.noise import mean_square
from steering_diagnosis.engine.remaining import Left, drifted, left_by
from steering_diagnosis.engine.search import Search
from steering_diagnosis.engine.structure import FreeForm, free_form
from steering_diagnosis.report import Verdict


@dataclass(frozen=True, repr=False)
class Kept:
    """The best model after what cannot stand was taken back, what it leaves, and notes on both.

    against: where the record speaks against what was taken back.
    """

    best: Fit
    left: list[Left]
    notes: tuple[str, ...] = ()
    against: tuple[Region, ...] = ()

    @property
    def noise(self) -> np.ndarray:
        """Mean square of each output of the fitted record that is noise, (outputs,)."""
        return self.left[0].noise

    @property
    def held_noise(self) -> np.ndarray:
        """The same of the held-out samples: of a second record, its own."""
        return self.left[-1].noise


def conclude(search: Search, best: Fit, block: np.ndarray) -> Findings:
    """Judge the best model of a search and gather everything that a report needs."""
    problem, null = search.problem, search.null
    kept = _standing(search, best, block)
    best, noise = kept.best, kept.noise
    evidence = {n: search.weigh(search.without(best, n), best) for n in sorted(best.names)}
    rivals = {n: _rivals(search, best, n, block) for n in sorted(best.names)}
    held_noise = kept.held_noise + drifted(search, best)
    causes = _causes(search, best, evidence, rivals, block, held_noise)
    least = problem.settings.least_unexplained
    regions = [r for left in kept.left for r in left.regions(least)] or list(kept.against)
    ends = pressed(search, best)
    if not regions and not causes:
        apart = records_apart(search, noise)
        regions = [apart] if apart else [end.region for end in ends]
    undecidable = _undecidable(search)
    book = problem.book
    call, call0 = book.call(best.z, best.values), book.call(null.z, null.values)
    nominal = problem.known(problem.runs.one(book.call(0.0 * null.z, {})))
    step, spread = posterior(problem, best)
    return Findings(
        verdict=_verdict(causes, bool(regions), len(undecidable) == len(book.hypotheses)),
        causes=causes,
        unexplained=tuple(regions),
        losers=_losers(search, best, evidence, rivals),
        free_form=_free_form(kept.left[0]),
        outputs=tuple(problem.runs.replay.outputs),
        catalogue=book.nuisances,
        refitted=call0.nuisances,
        nuisances=call.nuisances,
        effects=call.effects,
        fitted=_rms(search, noise, nominal, null, best, problem.training),
        held_out=_held_rms(search, held_noise, nominal, null, best),
        undecidable=undecidable,
        explained=kept.left[0].explained if best.values else 0.0,
        calls=problem.runs.calls,
        step_s=problem.runs.grid.step_s,
        step=step,
        spread=spread,
        active=tuple((n, p.name) for n in best.values for p in book.hypotheses[n].parameters),
        held_out_samples=_samples_out(search, len(block)),
        residual_nominal=nominal,
        residual_refitted=null.residual,
        residual_extended=best.residual,
        notes=(*kept.notes, *(end.text for end in ends), *_not_tried(search)),
    )


def _standing(search: Search, best: Fit, block: np.ndarray) -> Kept:
    """Take back causes that explain too little, that nothing shows, or that leave structure."""
    left = left_by(search, best, block)
    notes: tuple[str, ...] = ()
    unconfirmed: list[Region] = []
    for name in _unseen(search, best, left[-1].noise):
        notes = (*notes, f"{name} was left out: held out, no output's error stands above its noise")
        reduced = search.without(best, name)
        unconfirmed += left[0].unconfirmed(reduced.residual - best.residual)
        best = reduced
        left = left_by(search, best, block)
    if not best.values:
        return Kept(best, left, notes, tuple(unconfirmed))
    names = ", ".join(sorted(best.names))
    if left[0].explained < search.problem.settings.least_explained:
        why = f"the best causes explain only {left[0].explained:.0%} of the error: {names}"
        return Kept(search.null, left_by(search, search.null, block), (*notes, why))
    least = search.problem.settings.spoiling
    causes = [search.problem.book.hypotheses[name] for name in best.names]
    spoiling = tuple(region for record in left for region in record.spoiling(least, causes))
    if spoiling:
        outputs = ", ".join(dict.fromkeys(r.output for r in spoiling))
        why = f"withdrawn, because what they leave in {outputs} is no noise: {names}"
        return Kept(search.null, left_by(search, search.null, block), (*notes, why), spoiling)
    return Kept(best, left, notes, tuple(unconfirmed))


def _unseen(search: Search, best: Fit, noise: np.ndarray) -> list[str]:
    return [n for n in sorted(best.names) if not _stands_out(search, best, n, noise)]


def _free_form(left: Left) -> FreeForm | None:
    """Return a smooth term for the strongest structure, if it predicts held-out blocks."""
    if not left.structures:
        return None
    return free_form(left.remains, max(left.structures, key=lambda s: s.energy / s.noise))


def _samples_out(search: Search, samples: int) -> np.ndarray:
    """Return which samples of the fitted record were held out, (samples,)."""
    if search.held.runs is not None:
        return np.zeros(samples, bool)
    return np.asarray(search.held.rows.any(axis=1))


def _stands_out(search: Search, best: Fit, name: str, noise: np.ndarray) -> bool:
    """Return whether a cause's part of the error stands above the noise of any held-out output."""
    held, problem = search.held, search.problem
    before = held.energy(held.residual(problem, search.without(best, name)))
    after = held.energy(held.residual(problem, best))
    return bool(np.any(before - after > problem.settings.least_visible * noise))


def _rivals(search: Search, best: Fit, cause: str, block: np.ndarray) -> list[Comparison]:
    """Return every refitted rival in the place of a cause, against the best model."""
    base = search.without(best, cause)
    search.extended(base, search.problem.settings.refitted)
    names = [n for n in search.fits if len(n) == len(best.names) and n - best.names]
    others = [search.fits[n] for n in names if n > base.names and cause not in n]
    compared = [
        search.tried(f.names, partial(compare, search.problem, best, f, cause, block))
        for f in others
    ]
    return [c for c in compared if c]


def _causes(
    search: Search,
    best: Fit,
    evidence: Mapping[str, Evidence],
    rivals: Mapping[str, list[Comparison]],
    block: np.ndarray,
    noise: np.ndarray,
) -> tuple[NamedCause, ...]:
    estimates = intervals(search.problem, best, block)
    found = []
    for name in sorted(best.names, key=lambda n: -evidence[n].ratio):
        h = search.problem.book.hypotheses[name]
        group = tuple(c.rival for c in as_good(rivals[name], search.problem.settings.rival_sigmas))
        found.append(
            NamedCause(
                h,
                estimates[name],
                evidence[name],
                group,
                _separating(search, name, group),
                _gain(search, search.without(best, name), best, noise),
            )
        )
    return tuple(found)


def _separating(search: Search, name: str, group: tuple[str, ...]) -> str | None:
    """Return what experiment separates a group, from what its members ask for."""
    if not group:
        return None
    members = [search.problem.book.hypotheses[n] for n in (name, *group)]
    texts = [h.separating or h.excitation for h in members]
    known = list(dict.fromkeys(t for t in texts if t))
    return "; ".join(known) or f"an experiment that excites {', '.join(h.name for h in members)}"


def _gain(search: Search, without: Fit, full: Fit, noise: np.ndarray) -> dict[str, float]:
    held, problem = search.held, search.problem
    before = held.energy(held.residual(problem, without))
    after = held.energy(held.residual(problem, full))
    found = {}
    for j, output in enumerate(problem.runs.replay.outputs):
        above = before[j] - noise[j]
        if above > 0.25 * noise[j]:
            found[output.name] = float(np.clip((before[j] - after[j]) / above, -1.0, 1.0))
    return found


def _undecidable(search: Search) -> dict[str, str]:
    """Return hypotheses whose visible size moves nothing above the noise."""
    problem, noise = search.problem, search.problem.noise(search.null.residual)
    strongest: dict[str, float] = {}
    for t in search.trials:
        white = noise.whiten(problem.known_columns(t)) * problem.weights()[..., None]
        energy = float(np.sum(white**2, axis=(0, 1)).max())
        strongest[t.hypothesis] = max(strongest.get(t.hypothesis, 0.0), energy)
    found = {}
    for name, energy in strongest.items():
        if energy < 9.0:
            needs = problem.book.hypotheses[name].excitation
            found[name] = "a visible size moves nothing above the noise in this record" + (
                f"; needs {needs}" if needs else ""
            )
    return found


def _losers(
    search: Search,
    best: Fit,
    evidence: Mapping[str, Evidence],
    rivals: Mapping[str, list[Comparison]],
) -> tuple[Loser, ...]:
    """Return every hypothesis that was weighed and not named, best first, and what failed."""
    found: dict[str, Loser] = {}
    for cause, compared in rivals.items():
        for c in compared:
            worse = f"fits worse than {cause} by {c.excess:.1f} ({c.sigmas:.1f} sigma)"
            found[c.rival] = Loser(c.rival, evidence[cause].ratio - c.excess, worse)
    for score in search.scores(best):
        name = score.hypothesis
        if name in best.names or name in found:
            continue
        fit = search.fits.get(best.names | {name})
        weighed = fit and search.tried(fit.names, partial(search.weigh, best, fit))
        why = weighed.why_not if weighed else "adds too little to what is found"
        found[name] = Loser(name, score.gain, why or "not kept by the search")
    for score in search.scores(search.null):
        if score.hypothesis not in best.names:
            text = "explains less than what is named" if best.names else "explains too little"
            found.setdefault(score.hypothesis, Loser(score.hypothesis, score.gain, text))
    for names, why in search.failed.items():
        for name in names - best.names:
            if len(names) == 1 or name not in found:
                found[name] = Loser(name, 0.0, f"could not be tried: {why}")
    return tuple(sorted(found.values(), key=lambda r: (-r.score, r.hypothesis)))


def _not_tried(search: Search) -> list[str]:
    """Return a note for each model that could not be evaluated."""
    return [
        f"could not be tried: {' and '.join(sorted(names))}: {why}"
        for names, why in search.failed.items()
    ]


def _verdict(causes: tuple[NamedCause, ...], visible: bool, blind: bool) -> Verdict:
    if causes:
        return "ambiguous" if any(c.ambiguous_with for c in causes) else "named"
    if visible:
        return "unexplained"
    return "insufficient_excitation" if blind else "clean"


def _rms(
    search: Search, noise: np.ndarray, nominal: np.ndarray, null: Fit, best: Fit, rows: np.ndarray
) -> dict[str, Rms]:
    parts = [np.sqrt(mean_square(r, rows)) for r in (nominal, null.residual, best.residual)]
    return _named_rms(search, np.sqrt(noise), parts)


def _held_rms(
    search: Search, noise: np.ndarray, nominal: np.ndarray, null: Fit, best: Fit
) -> dict[str, Rms]:
    held: HeldOut = search.held
    plain = Fit(0.0 * null.z, {}, nominal, null.noise, 0.0)
    parts = [np.sqrt(held.energy(held.residual(search.problem, f))) for f in (plain, null, best)]
    return _named_rms(search, np.sqrt(noise), parts)


def _named_rms(search: Search, noise: np.ndarray, parts: list[np.ndarray]) -> dict[str, Rms]:
    return {
        o.name: Rms(float(noise[j]), *(float(p[j]) for p in parts))
        for j, o in enumerate(search.problem.runs.replay.outputs)
    }
