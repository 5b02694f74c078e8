"""Cases: what is hidden in a record, drawn from a seed, and the sealed truth about it."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from steering_core.errors import BenchError
from steering_core.naming import unknown
from steering_core.parameters import ParameterSet, load_parameters
from steering_diagnosis.benchmark.doors.channel_sets import lacking_in
from steering_diagnosis.benchmark.doors.door import ALL_IN_A_BAG, Door
from steering_diagnosis.benchmark.sealed import KINDS, Sealed, read_sealed
from steering_diagnosis.benchmark.truth.changes import BOTH, TrueEffect
from steering_diagnosis.benchmark.truth.course import Course, draw_course
from steering_diagnosis.benchmark.truth.disturbance import RESOLUTION, disturbance
from steering_diagnosis.benchmark.truth.effects import (
    TRUE_EFFECTS,
    changed,
    equivalents,
    neutral,
    signs,
)
from steering_diagnosis.benchmark.truth.listed import LEAST
from steering_diagnosis.benchmark.truth.outside import OUTSIDE
from steering_diagnosis.benchmark.truth.run import Signals, run_closed_loop
from steering_diagnosis.benchmark.truth.singing import sings
from steering_diagnosis.benchmark.truth.specimen import Specimen, draw_specimen
from steering_diagnosis.benchmark.view import View, is_visible, seen_as, through, told
from steering_diagnosis.benchmark.visibility import (
    INVISIBLE,
    Probe,
    Sensitivity,
    catalogue_for,
    sensitivity,
)

__all__ = ["KINDS", "Drawn", "Sealed", "draw_case", "read_sealed", "sealed_behind", "seen_as"]

SECONDS = 15.0
TRIES = 12


@dataclass(frozen=True, repr=False)
class Drawn:
    """A case with its signals.

    holdout: a second manoeuvre of the same specimen. view: what its record shows of what is hidden,
    None where nothing is.
    """

    sealed: Sealed
    nominal: ParameterSet
    signals: Signals
    specimen: Specimen
    holdout: Signals | None = None
    holdout_load: str = ""
    view: View | None = None


def sealed_behind(drawn: Drawn, door: Door) -> Sealed:
    """Return the truth about a case that comes in through a door."""
    lacking = lacking_in(drawn.sealed.valve_system, door.lacking)
    about = {"kind": door.kind, "lacking": list(lacking), "ways": list(door.logger.ways)}
    if drawn.view is None or door == ALL_IN_A_BAG:
        return replace(drawn.sealed, door=about)
    seen = told(through(drawn.view, door, drawn.signals))
    return replace(drawn.sealed, door=about, **seen)


def draw_case(
    kind: str, seed: int, effect: str | None = None, seconds: float = SECONDS, holdout: bool = False
) -> Drawn:
    """Return a case of a kind; the same seed gives the same bytes.

    effect: hide this one (a pair: this one and another). BenchError for an unknown kind or effect,
    or where it cannot be made visible within its largest size.
    """
    random = _random(kind, seed)
    system, wanted = _wanted(random, kind, effect)
    nominal = load_parameters()
    for _ in range(TRIES):
        course = _course(random, system, wanted, seconds)
        specimen = draw_specimen(nominal, random)
        found = _hide(random, kind, seed, system, course, specimen, nominal, wanted)
        if found is None:
            continue
        sealed, view = found
        made = changed(specimen, nominal, system, sealed.sizes)
        try:
            signals = _record(random, made, nominal, course, system)
            second = draw_course(random, seconds, None, course.load) if holdout else None
            if second is not None and course.kind == "large":
                second = draw_course(random, seconds, "large", course.load)
            kept = _record(random, made, nominal, second, system) if second is not None else None
        except BenchError:
            continue
        if sings(signals) or (kept is not None and sings(kept)):
            continue
        load = "" if second is None else second.load
        return Drawn(sealed, nominal, signals, made, kept, load, view)
    raise BenchError(f"no record of seed {seed} shows {', '.join(wanted)}: take another seed")


def system_of(kind: str, seed: int, effect: str | None) -> str:
    """Return the valve system of a case, without drawing the rest of it."""
    return _wanted(_random(kind, seed), kind, effect)[0]


def _random(kind: str, seed: int) -> np.random.Generator:
    if kind not in KINDS:
        raise BenchError(unknown("kind of case", kind, KINDS))
    return np.random.default_rng([seed, KINDS.index(kind)])


def _record(
    random: np.random.Generator, made: Specimen, nominal: ParameterSet, course: Course, system: str
) -> Signals:
    noise = disturbance(random, len(course.angle))
    return run_closed_loop(made, nominal, course, system == "closed_centre", noise, RESOLUTION)


def _wanted(random: np.random.Generator, kind: str, effect: str | None) -> tuple[str, list[str]]:
    """Return the valve system and the effects to hide."""
    systems = [x for x in BOTH if effect is None or effect in TRUE_EFFECTS[x]]
    if not systems:
        known = sorted({n for x in BOTH for n in TRUE_EFFECTS[x]})
        raise BenchError(unknown("effect", str(effect), known))
    system = str(random.choice(systems))
    outside = [e.name for e in OUTSIDE]
    listed = sorted(set(TRUE_EFFECTS[system]) - set(outside))
    first = effect or str(random.choice(outside if kind == "outside" else listed))
    if kind == "clean":
        return system, []
    if kind != "pair":
        return system, [first]
    loads = set(TRUE_EFFECTS[system][first].loads)
    others = [
        n
        for n in listed
        if n != first
        and (not loads or not (own := set(TRUE_EFFECTS[system][n].loads)) or own & loads)
    ]
    return system, [first, str(random.choice(others))]


def _course(random: np.random.Generator, system: str, wanted: list[str], seconds: float) -> Course:
    """Return a manoeuvre with a load on which all wanted effects can act."""
    effects = [TRUE_EFFECTS[system][name] for name in wanted]
    while True:
        kinds = [k for e in effects for k in e.kinds]
        course = draw_course(random, seconds, kinds[0] if kinds else None)
        if all(not e.loads or course.load in e.loads for e in effects):
            return course
        allowed = [e.loads for e in effects if e.loads]
        common = sorted(set.intersection(*map(set, allowed)))
        if kinds and "none" not in common:
            raise BenchError(f"no manoeuvre shows {', '.join(wanted)} together: take another seed")
        if course.kind not in ("large", "park"):
            return draw_course(random, seconds, course.kind, str(random.choice(common)))


def _hide(
    random: np.random.Generator,
    kind: str,
    seed: int,
    system: str,
    course: Course,
    specimen: Specimen,
    nominal: ParameterSet,
    wanted: list[str],
) -> tuple[Sealed, View | None] | None:
    """Return the sealed truth with drawn sizes, None where this record cannot show them."""
    about: dict[str, Any] = {
        "case": f"{kind}-{seed:06d}",
        "kind": kind,
        "seed": seed,
        "valve_system": system,
        "manoeuvre": course.kind,
        "load": course.load,
    }
    if not wanted:
        return Sealed(**about), None
    try:
        given = run_closed_loop(specimen, nominal, course, system == "closed_centre")
        probe = Probe(specimen, nominal, system, course, given)
        rivals = catalogue_for(system, course)
        hidden = {name: TRUE_EFFECTS[system][name] for name in wanted}
        seen = sensitivity(probe, rivals | hidden)
    except BenchError:
        return None
    sizes = {}
    for name, effect in hidden.items():
        size = _size(random, kind, effect, seen, probe)
        if size is None:
            return None
        sizes[name] = size
    try:
        found = seen_as(kind, probe, seen, sizes)
    except BenchError:
        return None
    if kind == "pair" and not all(is_visible(e, seen, found[n]) for n, e in hidden.items()):
        return None
    judged = {n: e for n, e in hidden.items() if e.catalogued}
    view = View(kind, probe, seen, found, hidden, rivals, sizes)
    sealed = Sealed(
        **about,
        sizes=sizes,
        parameters=equivalents(system, {n: sizes[n] for n in judged}),
        neutral={name: neutral(system, name) for name in judged},
        **told(view) | {"unseen": []},
    )
    return sealed, view


def _size(
    random: np.random.Generator, kind: str, effect: TrueEffect, seen: Sensitivity, probe: Probe
) -> float | None:
    """Return a size drawn log-uniformly between visible and large, or below what can be seen."""
    if effect.name not in seen.effects:
        return None
    sign = signs(effect, random) * (1.0 if effect.typical > 0.0 else -1.0)
    typical = abs(effect.typical)
    if kind == "invisible":
        return (
            sign
            * float(random.uniform(0.2, 1.0))
            * typical
            * INVISIBLE
            / max(seen.ratio(effect.name), 1e-9)
        )
    low = max(seen.smallest_visible(effect.name), LEAST.get(effect.name, 0.0))
    high = abs(effect.largest)
    if effect.kinds:
        low = max(low, typical)
    # The scale is not straight: a tolerance imitates a small size better than a large one.
    while low <= high and not is_visible(effect, seen, probe.effect(effect, sign * low)):
        low *= 1.5
    if low > high:
        return None
    high = min(high, 30.0 * low)
    return sign * float(np.exp(random.uniform(np.log(low), np.log(high))))
