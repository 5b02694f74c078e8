"""Cases: what is hidden in a record, drawn from a seed, and the sealed truth about it."""

from __future__ import annotations

import hashlib
import json
from collections.abc import Mapping
from dataclasses import asdict, dataclass, field
from pathlib import Path
from typing import Any, Literal, get_args

import numpy as np

from steering_core.errors import BenchError
from steering_core.naming import unknown
from steering_core.parameters import ParameterSet, load_parameters
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
from steering_diagnosis.benchmark.visibility import (
    INVISIBLE,
    OUTSTANDING,
    Probe,
    Sensitivity,
    catalogue_for,
    sensitivity,
)

Kind = Literal["clean", "visible", "invisible", "pair", "outside"]
KINDS: tuple[Kind, ...] = get_args(Kind)
SECONDS = 15.0
TRIES = 12


@dataclass(frozen=True)
class Sealed:
    """The truth about a case, which no diagnosis sees.

    sizes: of the hidden effects, in the truth's own terms. parameters: effect to the library's
    parameters that are judged. neutral: effect to their values without it. mistaken: effect to
    those that this record cannot tell it from. ratios: signal to noise of each beside the others.
    """

    case: str
    kind: Kind
    seed: int
    valve_system: str
    manoeuvre: str
    load: str
    sizes: Mapping[str, float] = field(default_factory=dict)
    parameters: Mapping[str, Mapping[str, float]] = field(default_factory=dict)
    neutral: Mapping[str, float] = field(default_factory=dict)
    mistaken: Mapping[str, list[str]] = field(default_factory=dict)
    ratios: Mapping[str, float] = field(default_factory=dict)

    @property
    def hidden(self) -> tuple[str, ...]:
        """Return the names of what is hidden."""
        return tuple(self.sizes)

    def write(self, file: Path) -> None:
        """Write the truth with a hash of itself."""
        content = asdict(self)
        file.write_text(json.dumps({"truth": content, "sha256": _digest(content)}, indent=1) + "\n")


def read_sealed(file: Path) -> Sealed:
    """Return the truth of a file; BenchError where somebody has changed it."""
    try:
        document = json.loads(file.read_text(encoding="utf-8"))
        content, digest = document["truth"], document["sha256"]
    except (OSError, ValueError, KeyError, TypeError) as error:
        raise BenchError(f"'{file}' is no sealed truth: {error}") from None
    if _digest(content) != digest:
        raise BenchError(f"'{file}' has been changed since it was sealed: draw the case again")
    return Sealed(**content)


def _digest(content: Mapping[str, Any]) -> str:
    return hashlib.sha256(json.dumps(content, sort_keys=True).encode()).hexdigest()


@dataclass(frozen=True, repr=False)
class Drawn:
    """A case with its signals; holdout: a second manoeuvre of the same specimen."""

    sealed: Sealed
    nominal: ParameterSet
    signals: Signals
    specimen: Specimen
    holdout: Signals | None = None
    holdout_load: str = ""


def draw_case(
    kind: str, seed: int, effect: str | None = None, seconds: float = SECONDS, holdout: bool = False
) -> Drawn:
    """Return a case of a kind; the same seed gives the same bytes.

    effect: hide this one (a pair: this one and another). BenchError for an unknown kind or effect,
    or where it cannot be made visible within its largest size.
    """
    if kind not in KINDS:
        raise BenchError(unknown("kind of case", kind, KINDS))
    random = np.random.default_rng([seed, KINDS.index(kind)])
    system, wanted = _wanted(random, kind, effect)
    nominal = load_parameters()
    for _ in range(TRIES):
        course = _course(random, system, wanted, seconds)
        specimen = draw_specimen(nominal, random)
        sealed = _hide(random, kind, seed, system, course, specimen, nominal, wanted)
        if sealed is None:
            continue
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
        return Drawn(sealed, nominal, signals, made, kept, "" if second is None else second.load)
    raise BenchError(f"no record of seed {seed} shows {', '.join(wanted)}: take another seed")


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
) -> Sealed | None:
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
        return Sealed(**about)
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
    if kind == "pair" and not all(_visible(e, seen, found[n]) for n, e in hidden.items()):
        return None
    judged = {n: e for n, e in hidden.items() if e.catalogued}
    return Sealed(
        **about,
        sizes=sizes,
        parameters=equivalents(system, {n: sizes[n] for n in judged}),
        neutral={name: neutral(system, name) for name in judged},
        mistaken={n: [r for r in seen.mistaken(n, d) if r in rivals] for n, d in found.items()},
        ratios={name: seen.strength(difference) for name, difference in found.items()},
    )


def seen_as(
    kind: str, probe: Probe, seen: Sensitivity, sizes: Mapping[str, float]
) -> Mapping[str, np.ndarray]:
    """Return the difference that each effect makes, at its size and beside the others.

    What is too small to be seen is linear; a lag may be too short for these runs' step.
    """
    if kind != "invisible":
        return probe.beside(sizes)
    return {name: seen.effects[name] * (size / seen.sizes[name]) for name, size in sizes.items()}


def _visible(effect: TrueEffect, seen: Sensitivity, difference: np.ndarray) -> bool:
    """Return whether an effect's difference is visible; without a template it has to stand out."""
    if not seen.visible(difference):
        return False
    return effect.catalogued or seen.outstanding(effect.name, difference) >= OUTSTANDING


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
    while low <= high and not _visible(effect, seen, probe.effect(effect, sign * low)):
        low *= 1.5
    if low > high:
        return None
    high = min(high, 30.0 * low)
    return sign * float(np.exp(random.uniform(np.log(low), np.log(high))))
