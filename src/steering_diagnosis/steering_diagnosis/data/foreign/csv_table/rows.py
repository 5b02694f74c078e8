"""From the lines below a header to columns of cells, with the line that each row stands in."""

from __future__ import annotations

import csv
from collections import Counter
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from steering_core.errors import BenchError
from steering_diagnosis.data.foreign.csv_table.cells import is_missing, looks_measured
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

DIGITS = frozenset("0123456789")

FEW_ROWS = 10
"""So few rows between two equal headers are another table (of ranges, say), no measurement."""


PAUSE = "without a time it cannot be known how long a pause there is; cut the file there"
HINT = (
    "; is the decimal sign the separator too? `separator` and `header_line` in the mapping decide"
)


@dataclass(frozen=True, repr=False)
class Rows:
    """Columns of a table. cells: the wanted ones, n cells each; lines: (n,) int64, from 1.

    texts: the rows of texts between header and first number, all their cells; bad: (n,) bool, rows
    with more or fewer cells than they should have, which are empty here; longer: rows have empty
    cells behind those of the header; notes: a sentence each.
    """

    cells: tuple[tuple[str, ...], ...]
    lines: np.ndarray
    texts: tuple[tuple[str, ...], ...]
    bad: np.ndarray
    longer: bool
    notes: tuple[str, ...]


def read_rows(lines: Sequence[str], layout: Layout, columns: Sequence[int], timed: bool) -> Rows:
    """Return the cells of ``columns`` (from 0) of all rows below the header.

    timed: one of them is the time. Else rows are counted, and none may be missing in silence.

    Behind the header's cells a row may have empty ones, if all rows have as many. A row with more
    or fewer tells nothing: which cell is missing cannot be known. BenchError, with the line: too
    many of these, a quote that does not end, no numbers.
    """
    found = _Found(layout, columns, timed)
    count, first = len(layout.names), columns[0]
    for line, row in _rows(lines, layout, columns, timed):
        if len(row) == count and row[first][:1] in DIGITS:
            found.keep(line, count, tuple([row[column] for column in columns]))
        else:
            found.judge(line, row)
    found.without_blank_end()
    found.without_odd_rows()
    found.without_open_end(lines)
    return found.rows()


class _Found:
    """Rows as they come. picked: the wanted cells of each, None for a row that tells nothing."""

    def __init__(self, layout: Layout, columns: Sequence[int], timed: bool) -> None:
        self.layout, self.columns, self.timed = layout, list(columns), timed
        self.header = [layout.names[column] for column in columns]
        self.picked: list[tuple[str, ...] | None] = []
        self.lines: list[int] = []
        self.widths: list[int] = []
        self.texts: list[tuple[str, ...]] = []
        self.notes: list[str] = []
        self.again = False
        self.leading: tuple[int, int] | None = None

    def keep(self, line: int, width: int, cells: tuple[str, ...] | None) -> None:
        self.picked.append(cells)
        self.lines.append(line)
        self.widths.append(width)

    def judge(self, line: int, row: list[str]) -> None:
        """Keep a row, unless it is a header or stands before the first number."""
        if not self.layout.fits(row):
            if self.picked:
                self.keep(line, len(row), None)
            self.leading = self.leading or (line, len(row))
        elif not self._is_header(line, row):
            cells = tuple([row[column] for column in self.columns])
            if self.picked or any(map(looks_measured, cells)):
                self._check_text(line, row)
                self.keep(line, len(row), cells)
            else:
                self.texts.append(tuple(row))

    def _check_text(self, line: int, row: list[str]) -> None:
        """Raise BenchError where another table seems to begin and no time would show it."""
        texts = [cell for cell in row if not is_missing(cell) and not looks_measured(cell)]
        if not self.timed and len(texts) == len(self.layout.names):
            raise BenchError(f"line {line} is a row of texts: {PAUSE}")

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
        if not self.timed and self.picked:
            raise BenchError(f"the header stands in line {line} again: {PAUSE}")
        if not self.again:
            self.notes.append(f"the header stands in line {line} again: passed over")
        self.again = True
        return True

    def without_blank_end(self) -> None:
        """Forget rows of empty cells at the end; BenchError where nothing else is left."""
        while self.picked and (last := self.picked[-1]) and not any(c.strip() for c in last):
            for each in (self.picked, self.lines, self.widths):
                each.pop()
        if not self.picked:
            told = f"no numbers below the header in line {self.layout.header}"
            if self.leading is None:
                raise BenchError(told)
            raise BenchError(f"{told}: {self._cells(*self.leading)}{HINT}")

    def without_odd_rows(self) -> None:
        """Let rows tell nothing that have not as many cells as most rows have."""
        usual = Counter(self.widths).most_common(1)[0][0]
        for k, width in enumerate(self.widths):
            if width != usual:
                self.picked[k] = None
        odd = [k for k, cells in enumerate(self.picked) if cells is None]
        if not odd:
            return
        told = (
            f"{len(odd)} of {len(self.picked)} rows have more or fewer cells than they should "
            f"(first: {self._cells(self.lines[odd[0]], self.widths[odd[0]])})"
        )
        if len(odd) > LOST_SHARE * len(self.picked):
            raise BenchError(f"{told}{HINT}")
        self.notes.append(f"{told}: left out")

    def _cells(self, line: int, width: int) -> str:
        names, sign = len(self.layout.names), shown(self.layout.separator)
        return f"line {line} has {width} by {sign}, the header in line {self.layout.header} {names}"

    def without_open_end(self, lines: Sequence[str]) -> None:
        """Blank the last cell of a file whose last line has no end: it may be cut off."""
        line, last = len(lines), self.picked[-1]
        if self.lines[-1] != line or last is None or lines[-1].rstrip().endswith('"'):
            return
        row = row_of(lines[-1], self.layout.separator)
        if row[-1] and len(row) - 1 in self.columns:
            column = self.columns.index(len(row) - 1)
            self.picked[-1] = (*last[:column], "", *last[column + 1 :])
            self.notes.append(
                f"line {line}, the last one, has no end: the value of '{self.header[column]}' in "
                "it may be cut off and is left out"
            )

    def rows(self) -> Rows:
        empty = ("",) * len(self.columns)
        return Rows(
            cells=tuple(zip(*(cells or empty for cells in self.picked), strict=True)),
            lines=np.array(self.lines, dtype=np.int64),
            texts=tuple(self.texts),
            bad=np.array([cells is None for cells in self.picked]),
            longer=max(self.widths) > len(self.layout.names),
            notes=tuple(self.notes),
        )


def _rows(
    lines: Sequence[str], layout: Layout, columns: Sequence[int], timed: bool
) -> Iterator[tuple[int, list[str]]]:
    """Yield line and cells of each row that is neither blank nor a comment."""
    kept = _kept(lines, layout, timed)
    reader: Any = cells_of([lines[k] for k in kept], layout.separator)
    if not any('"' in lines[k] for k in kept):
        yield from zip((k + 1 for k in kept), reader, strict=True)
        return
    begin = 0
    try:
        for row in reader:
            line, end = kept[begin] + 1, reader.line_num
            if end > begin + 1:
                _check_quote([lines[k] for k in kept[begin + 1 : end]], line, layout, columns)
            begin = end
            yield line, row
    except csv.Error as error:
        raise BenchError(f"line {kept[begin] + 1}: {error}: a quote that does not end?") from None


def _kept(lines: Sequence[str], layout: Layout, timed: bool) -> list[int]:
    below = range(layout.first, len(lines))
    kept = [k for k in below if (line := lines[k]) and not line.isspace()]
    if not timed and kept and len(kept) < kept[-1] - kept[0] + 1:
        blank = next(k for k in range(kept[0], kept[-1]) if not lines[k].strip())
        raise BenchError(f"line {blank + 1} is blank: {PAUSE}, or write 'NaN' for a lost value")
    return [k for k in kept if not is_comment(lines[k], layout)]


def _check_quote(inner: Sequence[str], line: int, layout: Layout, columns: Sequence[int]) -> None:
    """Raise BenchError where a quoted cell with line ends has swallowed a row whole."""
    for text in inner:
        cells = row_of(text, layout.separator) if text.count('"') % 2 == 0 else []
        if layout.fits(cells) and any(looks_measured(cells[column]) for column in columns):
            raise BenchError(f"line {line}: a quote begins in it that does not end in its row")
