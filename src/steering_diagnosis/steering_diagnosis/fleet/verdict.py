"""The fleet's verdict: common causes and shifts, single causes, and what was not judged. Pure."""

from __future__ import annotations

from collections import Counter
from collections.abc import Mapping
from dataclasses import dataclass

from steering_diagnosis.engine.catalogue import PREFIX
from steering_diagnosis.fleet.shift import Shift, shifts
from steering_diagnosis.report import Report
from steering_plant.effects import EFFECTS

MOST = 0.5
"""Share of the specimens that could show a cause from which it is the model's, not a specimen's."""


@dataclass(frozen=True)
class Fleet:
    """What several specimens have in common, and what one has alone.

    common: cause to the specimens that have it. single: specimen to the causes that it has alone.
    unexplained: specimens with structure that no cause explains. shifts: of toleranced parameters.
    inside: parameters that common causes change. members: all that were judged.
    """

    members: tuple[str, ...]
    common: Mapping[str, tuple[str, ...]]
    single: Mapping[str, tuple[str, ...]]
    unexplained: tuple[str, ...]
    shifts: tuple[Shift, ...]
    inside: frozenset[str] = frozenset()

    @property
    def shifted(self) -> tuple[Shift, ...]:
        """The parameters that are off alike in all specimens, beside those of common causes."""
        return tuple(s for s in self.shifts if s.common and s.name not in self.inside)


def judged(reports: Mapping[str, Report]) -> Fleet:
    """Return the verdict on a fleet of at least two specimens, by name."""
    named = {name: _causes(report) for name, report in reports.items()}
    counts = Counter(cause for causes in named.values() for cause in causes)
    common = {
        cause: tuple(n for n, causes in named.items() if cause in causes)
        for cause, count in counts.items()
        if count > 1 and count > MOST * _could_show(cause, reports)
    }
    single = {
        name: tuple(c for c in causes if c not in common)
        for name, causes in named.items()
        if any(c not in common for c in causes)
    }
    learned = [report.learned for report in reports.values() if report.learned is not None]
    own = [
        frozenset(p for p, by in x.changed_by.items() if not set(by) <= common.keys())
        for x in learned
    ]
    found = shifts(learned, own)
    off = frozenset(s.name for s in found if s.common)
    # What all are off by is no cause of one of them: with it, these say something of it, too.
    found = shifts(learned, [names - off for names in own])
    off = frozenset(s.name for s in found if s.common)
    single = {
        name: left
        for name, causes in single.items()
        if (left := tuple(c for c in causes if not _explained(c, reports[name], off)))
    }
    inside = {p for x in learned for p, by in x.changed_by.items() if common.keys() & set(by)}
    return Fleet(
        tuple(reports),
        common,
        single,
        tuple(name for name, report in reports.items() if report.verdict == "unexplained"),
        tuple(found),
        frozenset(inside),
    )


def _causes(report: Report) -> tuple[str, ...]:
    return tuple(cause.effect for cause in report.causes)


def _explained(name: str, report: Report, off: frozenset[str]) -> bool:
    """Return whether a cause, or what it is not told from, is what all are off by."""
    (cause,) = (c for c in report.causes if c.effect == name)
    return any(_changes(n) and _changes(n) <= off for n in (name, *cause.ambiguous_with))


def _changes(cause: str) -> frozenset[str]:
    """Return the parameters of the data sheet that a cause changes."""
    if cause.startswith(PREFIX):
        return frozenset({cause.removeprefix(PREFIX)})
    return frozenset(EFFECTS[cause].sheet_parameters) if cause in EFFECTS else frozenset()


def _could_show(cause: str, reports: Mapping[str, Report]) -> int:
    return sum(cause not in report.undecidable for report in reports.values())
