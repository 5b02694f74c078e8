"""From cells to numbers. Which sign is the decimal one follows from cells with one reading only.

A point or comma is the decimal sign where the cell has no other reading (``0,5``, ``1,25``,
``1234,567``, ``1,5E3``, or the last one of both signs); it stands between thousands where it occurs
twice or before the other one (``1.234.567``). ``1,234`` has two readings: the column decides, or
the rest of the table, or, for a point between commas that separate, the separator.
"""

from __future__ import annotations

import re
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field
from functools import cache

import numpy as np

from steering_core.errors import BenchError
from steering_diagnosis.data.foreign.csv_table.cells import GROUPING, MISSING

OTHER = {".": ",", ",": "."}
"""The two signs that may be the decimal one, each with the other."""

PLAIN = frozenset("0123456789.+-eE \t\n")
"""Characters of numbers that ``float`` reads as they stand."""

POWER = r"(?:[eEdD][+\-−]?[0-9]+)"


@dataclass(frozen=True)
class Spelling:
    """How a column writes numbers: the decimal sign, and what may stand between thousands."""

    decimal: str = "."
    thousands: frozenset[str] = frozenset(GROUPING)


@dataclass(frozen=True, repr=False)
class Numbers:
    """A column read: texts (n,) that ``float`` takes, '' for none; values (n,) float64.

    foreign: rows whose cells are texts that stand neither for a number nor for a missing one.
    """

    texts: list[str]
    values: np.ndarray
    foreign: list[int]


@dataclass(frozen=True)
class Evidence:
    """What a column's cells tell: for each sign the first row with this reading."""

    decimal: dict[str, int] = field(default_factory=dict)
    thousands: dict[str, int] = field(default_factory=dict)
    either: dict[str, int] = field(default_factory=dict)

    def signs(self) -> dict[str, int]:
        """Return the decimal signs that follow from it, with the first row of each."""
        shown = dict(self.decimal)
        for sign, row in self.thousands.items():
            shown[OTHER[sign]] = min(row, shown.get(OTHER[sign], row))
        return shown


def spellings(
    columns: Sequence[tuple[str, Sequence[str]]],
    lines: np.ndarray,
    decimal: str | None = None,
    thousands: str | None = None,
    separator: str = "",
) -> list[Spelling]:
    """Return how each column, given as name and cells, writes its numbers.

    decimal and thousands: as the mapping gives them. BenchError where cells contradict each other
    or have two readings, with line and the mapping's key that decides.
    """
    if decimal is None and thousands in OTHER:
        decimal = OTHER[thousands]
    found = [evidence(cells) for _, cells in columns]
    everywhere = {sign for each in found for sign in each.signs()}
    if not everywhere and separator == ",":
        everywhere = {"."}
    default = next(iter(everywhere)) if len(everywhere) == 1 else None
    result = []
    for (name, cells), each in zip(columns, found, strict=True):
        place = _Place(name, cells, lines)
        own = decimal or _decimal(each, default, place)
        other = OTHER[own]
        grouped = other in each.thousands or thousands == other
        if other in each.either and not grouped:
            raise BenchError(
                f"{place(each.either[other])} has two readings beside the decimal sign '{own}', a "
                f"number with '{other}' between its thousands or none: say `thousands` in the "
                "mapping"
            )
        result.append(Spelling(own, frozenset(GROUPING + other if grouped else GROUPING)))
    return result


@dataclass(frozen=True)
class _Place:
    """Says where a cell of a column is."""

    name: str
    cells: Sequence[str]
    lines: np.ndarray

    def __call__(self, row: int) -> str:
        return f"line {self.lines[row]}: '{self.cells[row].strip()}' of '{self.name}'"


def _decimal(found: Evidence, default: str | None, place: _Place) -> str:
    """Return the decimal sign of a column; ``default`` is that of the rest of the table."""
    shown = found.signs()
    if len(shown) > 1:
        first, second = sorted(shown.values())
        raise BenchError(
            f"{place(first)} and {place(second)} cannot have the same decimal sign: say `decimal` "
            "in the mapping"
        )
    if shown:
        return next(iter(shown))
    if default is None and found.either:
        row = next(iter(found.either.values()))
        raise BenchError(
            f"{place(row)} may have a decimal sign or one between thousands, and no other cell "
            "tells: say `decimal` in the mapping"
        )
    return default or "."


def evidence(cells: Sequence[str]) -> Evidence:
    """Return what the cells tell of the two signs."""
    joined = "\n".join(cells)
    result = Evidence()
    for sign in OTHER:
        if sign in joined:
            for kind, pattern in _patterns(sign).items():
                if match := pattern.search(joined):
                    getattr(result, kind)[sign] = joined.count("\n", 0, match.start())
    return result


@cache
def _patterns(sign: str) -> dict[str, re.Pattern[str]]:
    """Return what shows that ``sign`` is decimal, between thousands, or either, in joined cells."""
    mark, other = re.escape(sign), re.escape(OTHER[sign])
    decimal = (
        rf"[0-9]+{mark}(?:[0-9]{{0,2}}|[0-9]{{4,}}){POWER}?",
        rf"(?:|0[0-9]*|[0-9]{{4,}}){mark}[0-9]+{POWER}?",
        rf"[0-9]+{mark}[0-9]{{3}}{POWER}",
        rf"[0-9]{{1,3}}(?:[{GROUPING}{other}][0-9]{{3}})+{mark}[0-9]*{POWER}?",
    )
    thousands = (
        rf"[0-9]{{1,3}}(?:{mark}[0-9]{{3}}){{2,}}",
        rf"[0-9]{{1,3}}(?:{mark}[0-9]{{3}})+{other}[0-9]*{POWER}?",
    )
    kinds = {
        "decimal": "|".join(decimal),
        "thousands": "|".join(thousands),
        "either": rf"[1-9][0-9]{{0,2}}{mark}[0-9]{{3}}",
    }
    return {
        kind: re.compile(rf"^[^\S\n]*[+\-−]?(?:{pattern})[^\S\n]*$", re.MULTILINE)
        for kind, pattern in kinds.items()
    }


def numbers(cells: Sequence[str], spelling: Spelling, missing: Iterable[str | float]) -> Numbers:
    """Return a column as numbers; ``missing`` are further texts or numbers that stand for none."""
    result = _as_they_stand(cells, spelling)
    if result is None:
        none = {str(each).strip().casefold() for each in missing}
        result = _one_by_one(cells, spelling, none | MISSING)
    for each in missing:
        if (number := _number_in(each)) is not None:
            lost = np.flatnonzero(result.values == number)
            result.values[lost] = np.nan
            for row in lost:
                result.texts[row] = ""
    return result


def _as_they_stand(cells: Sequence[str], spelling: Spelling) -> Numbers | None:
    """Return the numbers where all cells are what ``float`` reads, None where not."""
    joined = "\n".join(cells)
    if spelling.decimal != ".":
        if "." in joined:
            return None
        joined = joined.replace(spelling.decimal, ".")
    if not PLAIN.issuperset(joined):
        return None
    texts = joined.split("\n")
    try:
        return Numbers(texts, np.array([float(text) for text in texts]), [])
    except ValueError:
        return None


def _one_by_one(cells: Sequence[str], spelling: Spelling, missing: frozenset[str]) -> Numbers:
    pattern = _number(spelling)
    texts, foreign = [], []
    for row, cell in enumerate(cells):
        bare = cell.strip()
        if not bare or bare.casefold() in missing:
            texts.append("")
        elif match := pattern.fullmatch(bare):
            whole = re.sub("[^0-9]", "", match["whole"])
            sign = "-" if match["sign"] in ("-", "−") else ""
            power = f"e{match['power'][1:].replace('−', '-')}" if match["power"] else ""
            texts.append(f"{sign}{whole}.{match['part'] or ''}{power}")
        else:
            texts.append("")
            foreign.append(row)
    return Numbers(texts, np.array([float(t) if t else np.nan for t in texts]), foreign)


@cache
def _number(spelling: Spelling) -> re.Pattern[str]:
    between = "".join(map(re.escape, sorted(spelling.thousands)))
    mark = re.escape(spelling.decimal)
    grouped = rf"[0-9]{{1,3}}(?P<by>[{between}])[0-9]{{3}}(?:(?P=by)[0-9]{{3}})*"
    return re.compile(
        rf"(?P<sign>[+\-−]?)(?=[0-9]|{mark}[0-9])(?P<whole>{grouped}|[0-9]*)"
        rf"(?:{mark}(?P<part>[0-9]*))?(?P<power>{POWER})?"
    )


def _number_in(given: str | float) -> float | None:
    try:
        return float(given)
    except ValueError:
        return None
