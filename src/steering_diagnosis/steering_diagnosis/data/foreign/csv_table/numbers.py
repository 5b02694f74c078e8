"""From cells to numbers. Which sign is the decimal one follows from cells with one reading only.

A point or comma is the decimal sign where the cell has no other reading (``0,5``, ``1,25``,
``1234,567``, ``1,5E3``, or the last one of both signs); it stands between thousands where it occurs
twice or before the other one (``1.234.567``). ``1,234`` has two readings: the column decides, or
the rest of the table.
"""

from __future__ import annotations

import re
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field
from functools import cache

import numpy as np

from steering_core.errors import BenchError
from steering_diagnosis.data.foreign.csv_table.cells import GROUPING, MISSING, quoted

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
    decimal: the decimal sign, "" where no cell has any.
    """

    texts: list[str]
    values: np.ndarray
    foreign: list[int]
    decimal: str = ""


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


def read_columns(
    columns: Sequence[tuple[str, Sequence[str]]],
    lines: np.ndarray,
    decimal: str | None = None,
    thousands: str | None = None,
    missing: Iterable[str | float] = (),
) -> list[Numbers]:
    """Return the numbers of columns, each given as name and cells.

    decimal and thousands: as the mapping gives them; missing: further texts or numbers that stand
    for none. BenchError where cells contradict each other or have two readings, with line and the
    mapping's key that decides.
    """
    if decimal is None and thousands in OTHER:
        decimal = OTHER[thousands]
    plain = [_plain_column(cells, decimal) for _, cells in columns]
    found = [
        Evidence() if numbers else evidence(cells)
        for (_, cells), (_, numbers) in zip(columns, plain, strict=True)
    ]
    everywhere = {sign for sign, _ in plain if sign}
    everywhere |= {sign for each in found for sign in each.signs()}
    default = next(iter(everywhere)) if len(everywhere) == 1 else None
    result = []
    for (name, cells), (_, numbers), each in zip(columns, plain, found, strict=True):
        if numbers is None and each is not None:
            place = _Place(name, cells, lines)
            spelling = _spelling(each, decimal, thousands, default, place)
            numbers = _one_by_one(cells, spelling, missing)
        result.append(_without(numbers, missing))
    return result


def _plain_column(cells: Sequence[str], decimal: str | None) -> tuple[str, Numbers | None]:
    """Return the decimal sign and the numbers of a column that leaves no question open.

    It has but one of the two signs, in all cells what ``float`` reads, and one cell shows that the
    sign is the decimal one. The sign is '' where no cell has any.
    """
    joined = "\n".join(cells)
    signs = [sign for sign in OTHER if sign in joined]
    if len(signs) > 1 or (
        signs and not decimal and not _patterns(signs[0])["decimal"].search(joined)
    ):
        return "", None
    sign = signs[0] if signs else ""
    if sign and decimal not in (None, sign):
        return "", None
    texts = (joined.replace(",", ".") if sign == "," else joined).split("\n")
    if not PLAIN.issuperset(joined.replace(",", ".")):
        return "", None
    try:
        return sign, Numbers(
            texts, np.fromiter(map(float, texts), np.float64, len(texts)), [], sign
        )
    except ValueError:
        return "", None


def _spelling(
    found: Evidence,
    decimal: str | None,
    thousands: str | None,
    default: str | None,
    place: _Place,
) -> Spelling:
    """Return how a column writes numbers; ``default`` is the rest of the table's decimal sign."""
    own = decimal or _decimal(found, default, place)
    other = OTHER[own]
    grouped = other in found.thousands or thousands == other
    if other in found.either and not grouped:
        raise BenchError(
            f"{place(found.either[other])} has two readings beside the decimal sign '{own}', a "
            f"number with '{other}' between its thousands or none: say `thousands` in the mapping"
        )
    return Spelling(own, frozenset(GROUPING + other if grouped else GROUPING))


@dataclass(frozen=True)
class _Place:
    """Says where a cell of a column is."""

    name: str
    cells: Sequence[str]
    lines: np.ndarray

    def __call__(self, row: int) -> str:
        return f"line {self.lines[row]}: {quoted(self.cells[row])} of '{self.name}'"


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


def _one_by_one(
    cells: Sequence[str], spelling: Spelling, missing: Iterable[str | float]
) -> Numbers:
    """Return a column's numbers where its cells hold other things too."""
    none = MISSING | {str(each).strip().casefold() for each in missing}
    pattern = _number(spelling)
    texts, foreign = [], []
    for row, cell in enumerate(cells):
        bare = cell.strip()
        if not bare or bare.casefold() in none:
            texts.append("")
        elif match := pattern.fullmatch(bare):
            whole = re.sub("[^0-9]", "", match["whole"])
            sign = "-" if match["sign"] in ("-", "−") else ""
            power = f"e{match['power'][1:].replace('−', '-')}" if match["power"] else ""
            texts.append(f"{sign}{whole}.{match['part'] or ''}{power}")
        else:
            texts.append("")
            foreign.append(row)
    values = np.array([float(t) if t else np.nan for t in texts])
    used = spelling.decimal if any(spelling.decimal in cell for cell in cells) else ""
    return Numbers(texts, values, foreign, used)


def _without(read: Numbers, missing: Iterable[str | float]) -> Numbers:
    """Blank the numbers that stand for none."""
    for each in missing:
        if (number := _number_in(each)) is not None:
            lost = np.flatnonzero(read.values == number)
            read.values[lost] = np.nan
            for row in lost:
                read.texts[row] = ""
    return read


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
