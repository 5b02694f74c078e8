"""From a report to the experiment that is worth making next."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from concurrent.futures import Executor
from dataclasses import dataclass
from typing import Any

from steering_bringup.errors import BenchError
from steering_diagnosis.planning.candidates import CANDIDATES, scenario
from steering_diagnosis.planning.separation import NOISE, separations, visibility
from steering_diagnosis.report import Cause, Report
from steering_plant.effects import EFFECTS

FAINTEST = 0.05
"""Root mean square in noise units below which a thousand samples still show nothing."""


@dataclass(frozen=True)
class Experiment:
    """A scenario as data, and what it is good for. score: root mean square in noise units."""

    document: dict[str, Any]
    purpose: str
    score: float
    scores: dict[str, float]


Progress = Callable[[float, str], None]


def plan(
    report: Report,
    valve_system: str,
    *,
    executor: Executor | None = None,
    progress: Progress | None = None,
) -> Experiment:
    """Return the candidate that separates an ambiguous group best, or excites most.

    Raises BenchError where the report leaves nothing to plan.
    """
    noise = {name: s.noise for name, s in report.signals.items() if name in NOISE and s.noise > 0}
    groups = [cause for cause in report.causes if cause.ambiguous_with]
    if groups:
        causes = [_sized(name, groups[0]) for name in _group(groups[0])]
        purpose = f"tells {' from '.join(_group(groups[0]))}"
        jobs = [(separations, scenario(name, valve_system), causes) for name in CANDIDATES]
    elif report.verdict == "insufficient_excitation":
        wanted = [name for name in (report.undecidable or EFFECTS) if name in EFFECTS]
        causes = [{name: EFFECTS[name].values({})} for name in wanted]
        purpose = f"excites {len(causes)} effects that the record left in peace"
        jobs = [(_visible, scenario(name, valve_system), causes) for name in CANDIDATES]
    else:
        raise BenchError(
            f"nothing to plan: the verdict is '{report.verdict}' and no causes are ambiguous"
        )
    scores = dict(zip(CANDIDATES, _all(jobs, noise, executor, progress), strict=True))
    best = max(scores, key=lambda name: scores[name])
    if scores[best] < FAINTEST:
        raise BenchError(f"no experiment of the list {purpose}: at best {scores[best]:.2g} noises")
    return Experiment(scenario(best, valve_system), purpose, scores[best], scores)


def _group(cause: Cause) -> list[str]:
    return [cause.effect, *cause.ambiguous_with]


def _sized(name: str, cause: Cause) -> dict[str, dict[str, float]]:
    """Return an effect at its estimated size, or at its typical one where the report has none."""
    if name not in EFFECTS:
        raise BenchError(f"'{name}' is not an effect of the catalogue: nothing to simulate it by")
    given = {p: e.value for p, e in cause.parameters.items()} if name == cause.effect else {}
    return {name: EFFECTS[name].values(given)}


def _visible(document: Any, causes: Any, noise: Any) -> list[float]:
    """Return each cause's visibility; capped, so that one loud effect does not decide."""
    return [min(visibility(document, cause, noise), 3.0) for cause in causes]


def _all(
    jobs: list[tuple[Callable[..., list[float]], Any, Any]],
    noise: dict[str, float],
    executor: Executor | None,
    progress: Progress | None,
) -> Iterable[float]:
    """Yield each experiment's score: the worst pair, or the mean visibility."""
    calls = [(function, document, causes, noise) for function, document, causes in jobs]
    made = executor.map(_score, calls) if executor else map(_score, calls)
    for done, score in enumerate(made, start=1):
        if progress is not None:
            progress(done / len(calls), "")
        yield score


def _score(call: tuple[Callable[..., list[float]], Any, Any, Any]) -> float:
    function, document, causes, noise = call
    try:
        found = function(document, causes, noise)
    except BenchError:
        return 0.0
    return min(found) if function is separations else sum(found) / len(found)
