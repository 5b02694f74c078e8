"""What each missing channel costs: the same specimens with all channels, and without some."""

from __future__ import annotations

import statistics
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, replace

from steering_diagnosis.benchmark.cases import system_of
from steering_diagnosis.benchmark.doors.channel_sets import RIG, lacking_in
from steering_diagnosis.benchmark.doors.door import BAG, Door
from steering_diagnosis.benchmark.runner import Job
from steering_diagnosis.benchmark.scoring import PARAMETER_WITHIN, Judgement

SETS: Mapping[str, tuple[str, ...]] = {
    "all channels": (),
    "without the load's command": ("load_command",),
    "without the speeds": ("speeds",),
    "without the driver's torque": ("driver_torque",),
    "without the valve commands": ("valve_commands",),
    "without the left pressure": ("left_pressure",),
    "a rig's seven channels": RIG,
}
"""What is compared; bags all, so that nothing but channels differs."""

HEAD = (
    "channels",
    "hidden",
    "shown",
    "named right",
    "lost",
    "wrong names",
    "errors",
    "within 15 %",
    "covered",
    "half-width",
)


@dataclass(frozen=True)
class Cost:
    """Counts over the same specimens.

    cases: all. hidden: effects, visible with all channels. shown: those visible with these. right:
    of the shown that were named, alone or in a correct group. lost: named with all channels and not
    with these. wrong, errors: cases. within, covered: of ``parameters``. half_width: median over
    the distance from neutral, None where no interval was given.
    """

    what: str
    cases: int
    hidden: int
    shown: int
    right: int
    lost: int
    wrong: int
    errors: int
    parameters: int
    within: int
    covered: int
    half_width: float | None


def without_each(jobs: Iterable[Job]) -> list[Job]:
    """Return each job once for every set of channels that its gear can have."""
    found = []
    for job in jobs:
        system = system_of(job.kind, job.seed, job.effect)
        sets = dict.fromkeys(lacking_in(system, groups) for groups in SETS.values())
        found += [replace(job, door=Door(BAG, groups)) for groups in sets]
    return found


def costs(judgements: Iterable[Judgement]) -> list[Cost]:
    """Return what each set of channels costs."""
    by_specimen: dict[str, list[Judgement]] = {}
    for judgement in judgements:
        if judgement.door:
            by_specimen.setdefault(judgement.case.partition(".")[0], []).append(judgement)
    pairs: dict[str, list[tuple[Judgement, Judgement]]] = {}
    for found in by_specimen.values():
        whole = next((j for j in found if not j.door["lacking"]), None)
        if whole is None:
            continue
        for judgement in found:
            for name in _sets_of(judgement, whole):
                pairs.setdefault(name, []).append((whole, judgement))
    return [_cost(name, pairs[name]) for name in SETS if name in pairs]


def _sets_of(judgement: Judgement, whole: Judgement) -> list[str]:
    """Return the sets of channels that a judgement stands for; all are in one set alone."""
    lacking = tuple(judgement.door["lacking"])
    if judgement is whole:
        return ["all channels"]
    less = {name: (g, tuple(x for x in g if x != "valve_commands")) for name, g in SETS.items()}
    return [name for name, same in less.items() if lacking in same and lacking]


def _cost(what: str, pairs: Sequence[tuple[Judgement, Judgement]]) -> Cost:
    here = [judgement for _, judgement in pairs]
    errors = [e for j in here for e in j.errors.values()]
    widths = [w for j in here for w in j.half_widths.values()]
    seen = [(whole, j, h) for whole, j in pairs if j.kind in ("visible", "pair") for h in j.hidden]
    return Cost(
        what,
        len(pairs),
        len(seen),
        sum(h not in j.unseen for _, j, h in seen),
        sum(h in j.right for _, j, h in seen if h not in j.unseen),
        sum(h in whole.right and h not in j.right for whole, j, h in seen),
        sum(bool(j.wrong) for j in here),
        sum(bool(j.failure) for j in here),
        len(errors),
        sum(e <= PARAMETER_WITHIN for e in errors),
        sum(c for j in here for c in j.covered.values()),
        statistics.median(widths) if widths else None,
    )


def cells(cost: Cost) -> tuple[str, ...]:
    """Return a row of the table under ``HEAD``."""
    return (
        cost.what,
        str(cost.hidden),
        str(cost.shown),
        f"{cost.right} of {cost.shown}",
        str(cost.lost),
        f"{cost.wrong} of {cost.cases}",
        str(cost.errors),
        f"{cost.within} of {cost.parameters}",
        f"{cost.covered} of {cost.parameters}",
        "-" if cost.half_width is None else f"{100.0 * cost.half_width:.1f} %",
    )
