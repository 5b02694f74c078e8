"""Which line of a table is its header, and which sign separates its cells.

The rule: the header is the first line that, split by one of the separators, has every name of the
mapping as a cell, and below which rows of as many cells with numbers stand.
"""

from __future__ import annotations

import csv
from collections.abc import Iterable, Iterator, Sequence
from typing import NamedTuple

from steering_core.errors import BenchError
from steering_core.naming import unknown
from steering_diagnosis.data.foreign.csv_table.cells import is_missing, looks_measured
from steering_diagnosis.data.foreign.csv_table.names import places, plain
from steering_diagnosis.data.mapping import Mapping

NONE = "\x1f"
"""Separates nothing: a table of one column. No text has it."""

SEPARATORS = {"semicolon": ";", "tab": "\t", "comma": ",", "pipe": "|", "space": " ", "none": NONE}

COMMENTS = ("#", "%", "//")
"""What begins a comment line, where the mapping does not say."""

COMMENT_COLUMN = "Comment"
"""Last name in LabVIEW's headers (LVM); rows without a comment have no cell for it."""

REACH = 1000
"""Lines among which the header is looked for."""

FURTHER = 30
"""Lines below the first header among which another one would make a choice."""

PROBED = 300
"""Lines below a header by which it is judged."""

FITTING = 0.5
"""Least share of these that are rows of the header's table."""

HIGHEST_HEADER = 6
"""Lines that a header may take where quoted names have line ends in them."""


class Layout(NamedTuple):
    """How a table is laid out. header: its line from 1; first: index of the line below it.

    names: plain, up to the last one that is not empty; given: the mapping says which line is the
    header.
    """

    separator: str
    header: int
    first: int
    names: tuple[str, ...]
    comments: tuple[str, ...]
    given: bool

    def fits(self, row: Sequence[str]) -> bool:
        """Return whether a row has the header's cells, and behind them nothing or empty ones."""
        count = len(self.names)
        return len(row) >= count and not any(cell.strip() for cell in row[count:])


def shown(separator: str) -> str:
    """Return a separator in words."""
    return next((name for name, sign in SEPARATORS.items() if sign == separator), separator)


def cells_of(lines: Iterable[str], separator: str) -> Iterator[list[str]]:
    """Yield the cells of each row, quotes undone. Between blanks any number of them is one."""
    if separator == " ":
        lines = (line.replace("\t", " ").strip(" ") for line in lines)
    return csv.reader(lines, delimiter=separator, skipinitialspace=True)


def row_of(line: str, separator: str) -> list[str]:
    """Return the cells of one line."""
    return next(iter(cells_of([line], separator)), [])


def is_comment(line: str, layout: Layout) -> bool:
    """Return whether a comment sign begins the line; '#N/A' and its like are cells, not signs."""
    if not line.lstrip().startswith(layout.comments):
        return False
    row = row_of(line, layout.separator)
    return not (row and is_missing(row[0]))


def find_layout(lines: Sequence[str], wanted: Sequence[str], mapping: Mapping) -> Layout | None:
    """Return the layout of the table with all names ``wanted``, None where no line has them.

    BenchError: several lines or separators would do, and would mean other cells.
    """
    good: list[tuple[Layout, list[list[str]]]] = []
    bad: list[tuple[float, Layout]] = []
    for number in _numbers(lines, mapping):
        if good and number > good[0][0].header + FURTHER:
            break
        for layout in _layouts(lines, number, wanted, mapping):
            share, sample = _probe(lines, layout, wanted)
            if share >= FITTING:
                good.append((layout, sample))
            elif len(bad) < len(SEPARATORS):
                bad.append((share, layout))
    if good:
        return _only(good, [layout for _, layout in bad], wanted)
    return max(bad, key=lambda each: each[0])[1] if bad else None


def explain_missing(lines: Sequence[str], wanted: Sequence[str], mapping: Mapping) -> str:
    """Return what to say where no line has all the names: the likeliest header, and its names."""
    best, header, row = (-1, 0), 1, ["nothing"]
    for number in _numbers(lines, mapping):
        for separator in _separators(lines, mapping):
            names, _ = _names(lines, number, separator)
            if not any(name and not looks_measured(name) for name in names):
                continue
            found = sum(1 for name in wanted if places(name, names))
            if (found, len(names)) > best:
                best, header, row = (found, len(names)), number, names
    if best[0] < 0:
        return "no line of it has names, numbers only: give the file a header"
    missing = next((name for name in wanted if not places(name, row)), wanted[0])
    told = unknown("column", missing, [name for name in row if name])
    return f"line {header}: {told} (`header_line` and `separator` in the mapping say where)"


def _only(
    good: list[tuple[Layout, list[list[str]]]], bad: list[Layout], wanted: Sequence[str]
) -> Layout:
    """Return the first good layout, where the others, and bad ones below it, mean the same.

    Blanks separate only where no other sign does: they may stand within cells.
    """
    signs = [each for each in good if each[0].separator not in (" ", NONE)]
    good = signs or good
    chosen, cells = good[0]
    for other, others_cells in good[1:]:
        if other.header == chosen.header and others_cells != cells:
            raise BenchError(
                f"line {chosen.header} is a header by {shown(chosen.separator)} and by "
                f"{shown(other.separator)}: say `separator` in the mapping"
            )
    for other in (*(layout for layout, _ in good), *bad):
        if other.header > chosen.header and _columns(other, wanted) != _columns(chosen, wanted):
            raise BenchError(
                f"lines {chosen.header} and {other.header} may both be the header: say "
                "`header_line` in the mapping"
            )
    return chosen


def _columns(layout: Layout, wanted: Sequence[str]) -> list[list[int]]:
    return [places(name, layout.names) for name in wanted]


def _numbers(lines: Sequence[str], mapping: Mapping) -> range:
    """Return the lines, from 1, that may be the header."""
    if mapping.header_line is not None:
        return range(mapping.header_line, min(mapping.header_line, len(lines)) + 1)
    return range(1, min(len(lines), REACH) + 1)


def _layouts(
    lines: Sequence[str], number: int, wanted: Sequence[str], mapping: Mapping
) -> Iterator[Layout]:
    """Yield the layouts in which line ``number`` is a header with all the names."""
    text = lines[number - 1]
    if '"' not in text and not all(plain(name) in plain(text) for name in wanted):
        return
    comments = mapping.comment or COMMENTS
    sign = next((sign for sign in comments if text.lstrip().startswith(sign)), "")
    for separator in _separators(lines, mapping):
        headers = [_names(lines, number, separator)]
        if sign:
            bare = row_of(text.lstrip().removeprefix(sign).lstrip(" "), separator)
            headers.append(([plain(name) for name in bare], 1))
        for names, height in headers:
            if all(places(name, names) for name in wanted):
                filled = max(k for k, name in enumerate(names) if name) + 1
                layout = Layout(
                    separator=separator,
                    header=number,
                    first=number - 1 + height,
                    names=tuple(names[:filled]),
                    comments=comments,
                    given=mapping.header_line is not None,
                )
                yield layout
                if names[filled - 1] == COMMENT_COLUMN and COMMENT_COLUMN not in wanted:
                    yield layout._replace(names=tuple(names[: filled - 1]))


def _separators(lines: Sequence[str], mapping: Mapping) -> list[str]:
    if mapping.separator is not None:
        return [SEPARATORS.get(mapping.separator, mapping.separator)]
    said = lines[0].strip('" ')
    if said.lower().startswith("sep=") and len(said) == len("sep=") + 1:
        return [said[-1]]
    return list(SEPARATORS.values())


def _names(lines: Sequence[str], number: int, separator: str) -> tuple[list[str], int]:
    """Return the names of a header and how many lines they take."""
    text = lines[number - 1]
    for height in range(1, HIGHEST_HEADER + 1):
        whole = " ".join(lines[number - 1 : number - 1 + height])
        if whole.count('"') % 2 == 0:
            return [plain(name) for name in row_of(whole, separator)], height
    return [plain(name) for name in row_of(text, separator)], 1


def _probe(
    lines: Sequence[str], layout: Layout, wanted: Sequence[str]
) -> tuple[float, list[list[str]]]:
    """Return which share of the next lines are rows of this table, and their wanted cells."""
    columns = [column for name in wanted for column in places(name, layout.names)]
    below = lines[layout.first : layout.first + PROBED]
    kept = [line for line in below if line.strip() and not is_comment(line, layout)]
    right, wrong = [], 0
    for row in cells_of(kept, layout.separator):
        cells = [row[column].strip() for column in columns] if layout.fits(row) else []
        if any(map(looks_measured, cells)):
            right.append(cells)
        elif right or not cells:
            wrong += 1
    return len(right) / max(len(right) + wrong, 1), right
