"""From the lines below a header to columns of cells, with the line that each row stands in."""

from __future__ import annotations

import csv
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from steering_core.errors import BenchError
from steering_diagnosis.data.foreign.csv_table.cells import looks_measured
from steering_diagnosis.data.foreign.csv_table.layout import (
    Layout,
    cells_of,
    is_comment,
    row_of,
    shown,
)
from steering_diagnosis.data.foreign.csv_table.names import plain

LOST_SHARE = 0.1
"""Share of rows, or of a column's cells, that may be lost; beyond it a table is refused."""

FEW_ROWS = 10
"""So few rows between two equal headers are another table (of ranges, say), no measurement."""


@dataclass(frozen=True, repr=False)
class Rows:
    """Columns of a table. cells: the wanted ones, n cells each; lines: (n,) int64, from 1.

    texts: the rows of texts between header and first number, all their cells; bad: (n,) bool, rows
    with more or fewer cells than the header, whose cells are empty here; notes: a sentence each.
    """

    cells: tuple[tuple[str, ...], ...]
    lines: np.ndarray
    texts: tuple[tuple[str, ...], ...]
    bad: np.ndarray
    notes: tuple[str, ...]


def read_rows(lines: Sequence[str], layout: Layout, columns: Sequence[int]) -> Rows:
    """Return the cells of ``columns`` (from 0) of all rows below the header.

    A row with more or fewer cells than the header tells nothing: which cell is missing cannot be
    known. BenchError, with the line: too many of these, a quote that does not end, no numbers.
    """
    collected = _Collected(layout, columns)
    for line, row in _rows(lines, layout, columns):
        collected.add(line, row)
    return collected.rows(lines)


class _Collected:
    """Rows as they come. ``picked`` has the wanted cells of each, None for a bad row."""

    def __init__(self, layout: Layout, columns: Sequence[int]) -> None:
        self.layout, self.columns = layout, columns
        self.header = [layout.names[column] for column in columns]
        self.picked: list[tuple[str, ...] | None] = []
        self.lines: list[int] = []
        self.widths: dict[int, int] = {}
        self.texts: list[tuple[str, ...]] = []
        self.again: list[int] = []

    def add(self, line: int, row: list[str]) -> None:
        layout = self.layout
        if len(row) != layout.width and not layout.fits(row):
            if self.picked:
                self.widths[line] = len(row)
                self.picked.append(None)
                self.lines.append(line)
            return
        cells = tuple([row[column] for column in self.columns])
        if not cells[0][:1].isdigit():
            if self._is_header(line, row):
                return
            if not self.picked and not any(map(looks_measured, cells)):
                self.texts.append(tuple(row))
                return
        self.picked.append(cells)
        self.lines.append(line)

    def _is_header(self, line: int, row: list[str]) -> bool:
        """Return whether this is the header again; BenchError where it means something else."""
        names = [plain(cell) for cell in row]
        if not all(name in names for name in self.header):
            return False
        if [names[column] for column in self.columns] != self.header:
            raise BenchError(
                f"line {line}: a header with other columns than that in line {self.layout.header}: "
                "cut the file there"
            )
        if 0 < len(self.picked) < FEW_ROWS and not self.layout.given:
            raise BenchError(
                f"the header in line {self.layout.header} stands in line {line} again, after "
                f"{len(self.picked)} rows: say `header_line` in the mapping"
            )
        self.again.append(line)
        return True

    def rows(self, lines: Sequence[str]) -> Rows:
        picked, at = self.picked, self.lines
        while picked and picked[-1] is not None and not any(c.strip() for c in picked[-1]):
            picked.pop()
            at.pop()
        if not picked:
            raise BenchError(f"no numbers below the header in line {self.layout.header}")
        notes = self._notes(lines)
        empty = ("",) * len(self.columns)
        return Rows(
            cells=tuple(zip(*(cells or empty for cells in picked), strict=True)),
            lines=np.array(at, dtype=np.int64),
            texts=tuple(self.texts),
            bad=np.array([cells is None for cells in picked]),
            notes=tuple(notes),
        )

    def _notes(self, lines: Sequence[str]) -> list[str]:
        """Return what is to be said; blank the last cell where the file ends within it."""
        notes = []
        count, wanted = len(self.picked), len(self.layout.names)
        if self.widths:
            line, width = next(iter(self.widths.items()))
            told = (
                f"{len(self.widths)} of {count} rows have more or fewer cells than the header in "
                f"line {self.layout.header} (first: line {line}, {width} for {wanted})"
            )
            if len(self.widths) > LOST_SHARE * count:
                raise BenchError(
                    f"{told}, separated by {shown(self.layout.separator)}: a decimal sign that is "
                    "the separator too? `separator` and `header_line` in the mapping decide"
                )
            notes.append(f"{told}: left out")
        if self.again:
            notes.append(f"the header stands in line {self.again[0]} again: passed over")
        last = self.picked[-1]
        if self.lines[-1] == len(lines) and last is not None and self._ends_open(lines[-1]):
            column = self.columns.index(len(row_of(lines[-1], self.layout.separator)) - 1)
            self.picked[-1] = (*last[:column], "", *last[column + 1 :])
            notes.append(
                f"line {len(lines)}, the last one, has no end: the value of "
                f"'{self.header[column]}' in it may be cut off and is left out"
            )
        return notes

    def _ends_open(self, line: str) -> bool:
        """Return whether a file's last line, which has no end, ends within a wanted cell."""
        row = row_of(line, self.layout.separator)
        return not line.rstrip().endswith('"') and len(row) - 1 in self.columns and bool(row[-1])


def _rows(
    lines: Sequence[str], layout: Layout, columns: Sequence[int]
) -> Iterator[tuple[int, list[str]]]:
    """Yield line and cells of each row that is neither blank nor a comment."""
    kept = _kept(lines, layout)
    reader: Any = cells_of((lines[k] for k in kept), layout.separator)
    begin = 0
    try:
        for row in reader:
            line, end = kept[begin] + 1, reader.line_num
            if end > begin + 1:
                _check_quote(row, [lines[k] for k in kept[begin + 1 : end]], line, layout, columns)
            begin = end
            yield line, row
    except csv.Error as error:
        raise BenchError(f"line {kept[begin] + 1}: {error}: a quote that does not end?") from None


def _kept(lines: Sequence[str], layout: Layout) -> list[int]:
    below = range(layout.first, len(lines))
    kept = [k for k in below if (line := lines[k]) and not line.isspace()]
    if len(layout.names) == 1 and kept and len(kept) < kept[-1] - layout.first + 1:
        blank = next(k for k in range(layout.first, kept[-1]) if not lines[k].strip())
        raise BenchError(
            f"line {blank + 1} is blank: in a table of one column it may be a lost value or "
            "nothing; write 'NaN' there or take the line out"
        )
    return [k for k in kept if not is_comment(lines[k], layout)]


def _check_quote(
    row: list[str], inner: Sequence[str], line: int, layout: Layout, columns: Sequence[int]
) -> None:
    """Raise BenchError where a quoted cell with line ends has swallowed further rows."""
    for text in inner:
        cells = row_of(text, layout.separator)
        if layout.fits(cells) and any(looks_measured(cells[column]) for column in columns):
            break
    else:
        if layout.fits(row):
            return
    raise BenchError(f"line {line}: a quote begins in it that does not end in its row")
