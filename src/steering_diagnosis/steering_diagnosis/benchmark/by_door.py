"""The benchmark's rates by door: for each kind of file, each set of channels, each logger's way."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from steering_diagnosis.benchmark.doors.channel_sets import RIG
from steering_diagnosis.benchmark.doors.door import BAG
from steering_diagnosis.benchmark.scoring import PARAMETER_WITHIN, Judgement

FILES = {"bag": "bag", "csv": "CSV", "mdf": "MDF4", "matlab": "MATLAB"}
ALL, SEVEN, PLAIN = "all channels", "a rig's seven channels", "file, plain logger"
GROUPS = {
    "load_command": "without the load's command",
    "speeds": "without the speeds",
    "driver_torque": "without the driver's torque",
    "valve_commands": "without the valve commands",
    "left_pressure": "without one chamber's pressure",
    "right_pressure": "without one chamber's pressure",
}
WAYS = {
    "clock": "file, a clock of its own",
    "jitter": "file, stamps that jitter",
    "gaps": "file, gaps",
    "digits": "file, four digits",
}
ROWS = tuple(dict.fromkeys([*FILES.values(), ALL, *GROUPS.values(), SEVEN, PLAIN, *WAYS.values()]))
"""The table's rows, in its order."""


@dataclass(frozen=True)
class Row:
    """Counts of the cases of one row.

    right: of ``asked`` cases with one visible effect or two, those of which all were named, and
    nothing else. wrong, errors, unseen: cases with a wrong name, that ended in an error, and whose
    channels do not show what is hidden. alarms: cases of which nothing can be seen, called
    unexplained. within, covered: of ``parameters``.
    """

    what: str
    cases: int
    asked: int
    right: int
    wrong: int
    unseen: int
    alarms: int
    errors: int
    parameters: int
    within: int
    covered: int


HEAD = (
    "door",
    "cases",
    "named right",
    "wrong names",
    "not shown",
    "alarms",
    "errors",
    "within 15 %",
    "covered",
)


def by_door(judgements: Iterable[Judgement]) -> list[Row]:
    """Return the rows that have cases; a case counts in several."""
    members: dict[str, list[Judgement]] = {}
    for judgement in judgements:
        for name in rows_of(judgement.door) if judgement.door else ():
            members.setdefault(name, []).append(judgement)
    return [_row(name, members[name]) for name in ROWS if name in members]


def rows_of(door: Mapping[str, Any]) -> set[str]:
    """Return the rows that a case counts in. door: as the sealed truth has it."""
    lacking, ways = list(door["lacking"]), list(door["ways"])
    found = {FILES[door["kind"]], *(GROUPS[group] for group in lacking)}
    found |= {WAYS[way] for way in ways}
    found |= set() if lacking else {ALL}
    found |= set() if ways or door["kind"] == BAG else {PLAIN}
    # An open-centre valve has no commands that could lack.
    seven = lacking in (list(RIG), [group for group in RIG if group != "valve_commands"])
    return found | ({SEVEN} if seven else set())


def cells(row: Row) -> tuple[str, ...]:
    """Return a row of the table under ``HEAD``."""
    return (
        row.what,
        str(row.cases),
        f"{row.right} of {row.asked}",
        str(row.wrong),
        str(row.unseen),
        str(row.alarms),
        str(row.errors),
        f"{row.within} of {row.parameters}",
        f"{row.covered} of {row.parameters}",
    )


def _row(what: str, cases: Sequence[Judgement]) -> Row:
    asked = [j for j in cases if j.kind in ("visible", "pair") and not j.unseen]
    one = [j for j in asked if j.kind == "visible"]
    errors = [e for j in one for e in j.errors.values()]
    return Row(
        what,
        len(cases),
        len(asked),
        sum(set(j.right) == set(j.hidden) and not j.wrong for j in asked),
        sum(bool(j.wrong) and not j.imitated for j in cases),
        sum(bool(j.unseen) for j in cases),
        sum(j.unexplained for j in cases if j.kind in ("clean", "invisible") or _nothing(j)),
        sum(bool(j.failure) for j in cases),
        len(errors),
        sum(e <= PARAMETER_WITHIN for e in errors),
        sum(c for j in one for c in j.covered.values()),
    )


def _nothing(judgement: Judgement) -> bool:
    """Return whether the channels show nothing of what is hidden."""
    return set(judgement.unseen) == set(judgement.hidden) and not judgement.imitated
