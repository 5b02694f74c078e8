"""What a report is worth against the sealed truth, and the rates over many cases."""

from __future__ import annotations

import statistics
from collections import Counter
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import asdict, dataclass, field
from typing import Any

from scipy.stats import binomtest

from steering_diagnosis.benchmark.sealed import Sealed
from steering_diagnosis.benchmark.visibility import INVISIBLE

PARAMETER_WITHIN = 0.15
"""Error of a parameter over its distance from neutral."""

GAIN = 0.8


@dataclass(frozen=True)
class Judgement:
    """One report judged.

    named: of each cause its effect and what it is said to be ambiguous with. right: hidden effects
    that were named, alone or in a correct group; alone: by themselves. wrong: causes that are
    neither hidden nor, on this record, the same as what is hidden. errors, covered, half_widths:
    of judged parameters "effect.parameter", relative to the distance from neutral. gain: share of
    the held-out error energy above the noise that is gone, None where the report does not say.
    imitated: what is outside the catalogue looks like what is in it. door, unseen: as the sealed
    truth has them.
    """

    case: str
    kind: str
    hidden: tuple[str, ...]
    verdict: str
    named: tuple[tuple[str, ...], ...] = ()
    right: tuple[str, ...] = ()
    alone: tuple[str, ...] = ()
    wrong: tuple[str, ...] = ()
    unexplained: bool = False
    imitated: bool = False
    errors: Mapping[str, float] = field(default_factory=dict)
    covered: Mapping[str, bool] = field(default_factory=dict)
    half_widths: Mapping[str, float] = field(default_factory=dict)
    gain: float | None = None
    seconds: float = 0.0
    failure: str = ""
    door: Mapping[str, Any] = field(default_factory=dict)
    unseen: tuple[str, ...] = ()

    @property
    def as_it_should(self) -> bool:
        """Whether the report says what the case asks for, and nothing wrong beside it."""
        if self.wrong or self.failure:
            return False
        if self.kind == "outside" and not self.imitated:
            return self.unexplained
        if self.kind in ("visible", "pair") and not self.unseen:
            return set(self.right) == set(self.hidden)
        return not self.named or self.kind not in ("clean", "invisible")

    def as_json(self) -> dict[str, Any]:
        """Return the judgement as plain data."""
        return asdict(self)


def judge(report: Mapping[str, Any], sealed: Sealed, seconds: float = 0.0) -> Judgement:
    """Judge a report (design.md §7, or as much of it as a method gives) against the truth."""
    causes = list(report.get("causes") or [])
    groups = [(str(c["effect"]), *map(str, c.get("ambiguous_with") or [])) for c in causes]
    right, alone, wrong = [], [], []
    for group in groups:
        found = next((h for h in sealed.hidden if h in group and h not in right), None)
        same = set(sealed.mistaken.get(found or "", [])) | set(sealed.hidden)
        if found and len(group) <= 3 and all(name in same for name in group):
            right.append(found)
            alone += [found] if len(group) == 1 else []
        elif not any(set(group) <= {h, *sealed.mistaken.get(h, [])} for h in sealed.hidden):
            wrong.append(group[0])
    errors, covered, half_widths = _parameters(causes, sealed, alone)
    return Judgement(
        case=sealed.case,
        kind=sealed.kind,
        hidden=sealed.hidden,
        verdict=str(report.get("verdict", "")),
        named=tuple(groups),
        right=tuple(right),
        alone=tuple(alone),
        wrong=tuple(wrong),
        unexplained=bool(report.get("unexplained")) or report.get("verdict") == "unexplained",
        imitated=sealed.kind == "outside" and _imitated(sealed),
        errors=errors,
        covered=covered,
        half_widths=half_widths,
        gain=_gain(report) if right and not wrong else None,
        seconds=seconds,
        door=sealed.door,
        unseen=tuple(sealed.unseen),
    )


def _imitated(sealed: Sealed) -> bool:
    """Return whether known effects look like what is hidden, alone or several together.

    With all channels nothing is drawn that several imitate; with fewer they may.
    """
    together = any(sealed.ratios[name] > INVISIBLE for name in sealed.unseen)
    return together or any(sealed.mistaken.values())


def failed(sealed: Sealed, error: str, seconds: float) -> Judgement:
    """Return the judgement of a method that raised an error: nothing was named."""
    return Judgement(
        sealed.case,
        sealed.kind,
        sealed.hidden,
        "failed",
        seconds=seconds,
        failure=error,
        door=sealed.door,
        unseen=tuple(sealed.unseen),
    )


def _parameters(
    causes: Sequence[Mapping[str, Any]], sealed: Sealed, alone: Sequence[str]
) -> tuple[dict[str, float], dict[str, bool], dict[str, float]]:
    errors, covered, half_widths = {}, {}, {}
    for cause in causes:
        effect = str(cause["effect"])
        for parameter, true in sealed.parameters.get(effect, {}).items():
            estimate = (cause.get("parameters") or {}).get(parameter)
            if effect not in alone or estimate is None:
                continue
            name, distance = f"{effect}.{parameter}", abs(true - sealed.neutral[effect])
            errors[name] = abs(float(estimate["value"]) - true) / distance
            if estimate.get("low") is not None and estimate.get("high") is not None:
                low, high = float(estimate["low"]), float(estimate["high"])
                covered[name] = low <= true <= high
                half_widths[name] = 0.5 * (high - low) / distance
    return errors, covered, half_widths


def _gain(report: Mapping[str, Any]) -> float | None:
    """Return the share over all signals, each in units of its noise; it never exceeds 1."""
    gone = there = 0.0
    for signal in (report.get("signals") or {}).values():
        noise = max(float(signal["noise_holdout"]), 1e-30)
        before = (float(signal["rmse_refitted_holdout"]) / noise) ** 2
        after = (float(signal["rmse_extended_holdout"]) / noise) ** 2
        there += max(before - 1.0, 0.0)
        gone += max(before - 1.0, 0.0) - max(after - 1.0, 0.0)
    return gone / there if there > 0.0 else None


@dataclass(frozen=True)
class Rate:
    """A rate with its target: share (or median) of ``n``, 95 % interval (Wilson)."""

    what: str
    value: float | None
    n: int
    low: float | None
    high: float | None
    target: float
    at_least: bool = True

    @property
    def reached(self) -> bool | None:
        """Return whether the target is met, None where there was nothing to count."""
        if self.value is None:
            return None
        return self.value >= self.target if self.at_least else self.value <= self.target


def rates(judgements: Iterable[Judgement]) -> list[Rate]:
    """Return all rates of the benchmark with their targets."""
    by: dict[str, list[Judgement]] = {}
    for j in judgements:
        by.setdefault("unseen" if j.unseen and not j.imitated else j.kind, []).append(j)
    one, two, none = by.get("visible", []), by.get("pair", []), by.get("clean", [])
    outside = [j for j in by.get("outside", []) if not j.imitated]
    named = [bool(j.right) and not j.wrong for j in one]
    alone = [bool(j.alone) and not j.wrong for j in one]
    both = [set(j.right) == set(j.hidden) and not j.wrong for j in two]
    small = [bool(j.wrong) for j in by.get("invisible", [])]
    unseen = [bool(j.wrong) for j in by.get("unseen", [])]
    errors = [e for j in one for e in j.errors.values()]
    covered = [c for j in one for c in j.covered.values()]
    widths = [w for j in one for w in j.half_widths.values()]
    width = statistics.median(widths) if widths else None
    gains = [j.gain for j in one + two if j.right and not j.wrong and j.gain is not None]
    return [
        _rate("one effect: named alone or in a correct group", named, 0.95),
        _rate("one effect: alone and right", alone, 0.85),
        _rate("its parameter within 15 %", [e <= PARAMETER_WITHIN for e in errors], 0.95),
        _rate("its 95 % interval covers the truth", covered, 0.90),
        Rate("median half-width of it", width, len(widths), None, None, 0.15, False),
        _rate("two effects: both named", both, 0.80),
        _rate("clean: a false name", [bool(j.named) for j in none], 1.0 / 300.0, False),
        _rate("too small to be seen: a wrong name", small, 1.0 / 300.0, False),
        _rate("not shown by its channels: a wrong name", unseen, 1.0 / 300.0, False),
        _rate("outside the catalogue: unexplained", [j.unexplained for j in outside], 0.90),
        _rate("outside the catalogue: a wrong name", [bool(j.wrong) for j in outside], 0.05, False),
        _rate("named: 80 % of the held-out error gone", [g >= GAIN for g in gains], 0.95),
    ]


def _rate(what: str, hits: Sequence[bool], target: float, at_least: bool = True) -> Rate:
    n, k = len(hits), sum(map(bool, hits))
    if not n:
        return Rate(what, None, 0, None, None, target, at_least)
    interval = binomtest(k, n).proportion_ci(method="wilson")
    return Rate(what, k / n, n, float(interval.low), float(interval.high), target, at_least)


def confusion(judgements: Iterable[Judgement]) -> dict[str, dict[str, int]]:
    """Return what was hidden (one effect, or the kind) to what was said, with counts."""
    table: dict[str, Counter[str]] = {}
    for j in judgements:
        row = j.hidden[0] if len(j.hidden) == 1 and j.kind == "visible" else j.kind
        row = f"outside: {j.hidden[0]}" if j.kind == "outside" else row
        row = f"not shown: {', '.join(j.unseen)}" if j.unseen else row
        said = sorted(
            {group[0] if len(group) == 1 else " / ".join(sorted(group)) for group in j.named}
        )
        said = said or (
            ["(failed)"] if j.failure else ["(unexplained)"] if j.unexplained else ["(nothing)"]
        )
        table.setdefault(row, Counter()).update(said)
    return {row: dict(counts) for row, counts in sorted(table.items())}
