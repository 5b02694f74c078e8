"""A text table as raw channels."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from steering_core.errors import BenchError
from steering_diagnosis.data.foreign.csv_table.cells import is_missing, quoted
from steering_diagnosis.data.foreign.csv_table.encoding import read_texts
from steering_diagnosis.data.foreign.csv_table.instants import are_instants, counted, instants
from steering_diagnosis.data.foreign.csv_table.layout import (
    Layout,
    explain_missing,
    find_layout,
    row_of,
    shown,
)
from steering_diagnosis.data.foreign.csv_table.names import places, plain, split_unit
from steering_diagnosis.data.foreign.csv_table.numbers import OTHER, Numbers, read_columns
from steering_diagnosis.data.foreign.csv_table.rows import LOST_SHARE, Rows, read_rows
from steering_diagnosis.data.foreign.raw import Raw, check_own
from steering_diagnosis.data.mapping import Mapping
from steering_diagnosis.data.units import factor, is_unit

LATEST_S = 1e10
"""s since 1970, in the year 2286. A later time has another unit than it is said to have."""

Asked = tuple[str, int | None]
"""A column as the mapping names it: its name, and its number from 1 where that is needed."""


@dataclass(frozen=True, repr=False)
class Table:
    """A table found: encoding, lines, layout, and the column (from 0) of each one asked for."""

    encoding: str
    lines: Sequence[str]
    layout: Layout
    columns: dict[Asked, int]


def read_csv(path: Path, mapping: Mapping) -> dict[str, Raw]:
    """Return the channels of a text table, by the bench's names.

    BenchError names the file, the line, what is wrong there, and the mapping's key that decides.
    """
    try:
        return _channels(_table(path, mapping), mapping)
    except BenchError as error:
        text = str(error)
        raise BenchError(text if f"'{path}'" in text else f"'{path}', {text}") from None


def _table(path: Path, mapping: Mapping) -> Table:
    """Return the table in the file, in the first encoding in which all its names are found."""
    asked: list[Asked] = [(each.source, each.column) for each in mapping.channels.values()]
    if mapping.time:
        asked.append((mapping.time, mapping.time_column))
    wanted = list(dict.fromkeys(name for name, _ in asked))
    first: list[str] = []
    for encoding, text in read_texts(path, mapping.encoding):
        lines = text.split("\n")
        first = first or lines
        if layout := find_layout(lines, wanted, mapping):
            return Table(encoding, lines, layout, {each: _column(each, layout) for each in asked})
    raise BenchError(explain_missing(first, wanted, mapping))


def _column(asked: Asked, layout: Layout) -> int:
    """Return the column, from 0, that a mapping's name and number mean."""
    name, number = asked
    found = places(name, layout.names)
    where = ", ".join(str(place + 1) for place in found)
    if number is None and len(found) > 1:
        raise BenchError(
            f"line {layout.header}: the name '{name}' occurs {len(found)} times, in columns "
            f"{where}: say which with `column` (`time_column` for the time) in the mapping"
        )
    if number is not None and number - 1 not in found:
        raise BenchError(f"line {layout.header}: '{name}' is not in column {number} but in {where}")
    return found[0] if number is None else number - 1


def _channels(table: Table, mapping: Mapping) -> dict[str, Raw]:
    layout = table.layout
    columns = sorted(set(table.columns.values()))
    clock = table.columns.get((mapping.time, mapping.time_column)) if mapping.time else None
    rows = read_rows(table.lines, layout, columns, timed=clock is not None)
    cells = dict(zip(columns, rows.cells, strict=True))
    time, time_unit = None, ""
    if clock is not None and (mapping.time_format or are_instants(cells[clock])):
        time = _dates(cells.pop(clock), rows, layout.names[clock], mapping)
    read = _numbers(cells, rows, layout, mapping)
    units = _units(table, rows, mapping)
    if clock is not None and time is None:
        time_unit = units[clock] if is_unit(units[clock], "s") else ""
        time = _counted(read[clock], rows, layout.names[clock], time_unit, mapping)
    way = _way(table, rows, read, units, mapping)
    check_own(
        ((n, c.source, table.columns[c.source, c.column]) for n, c in mapping.channels.items()),
        f"line {layout.header}",
    )
    result: dict[str, Raw] = {}
    for name, channel in mapping.channels.items():
        column = table.columns[channel.source, channel.column]
        if column == clock:
            raise BenchError(f"line {layout.header}: {name}: '{channel.source}' is the time")
        if column not in read:
            raise BenchError(f"line {layout.header}: '{channel.source}' holds dates, no numbers")
        lost = _lost(cells[column], read[column], rows)
        if not lost and clock in read:
            lost = _lost(cells[clock], read[clock], rows)
        values = read[column].values
        result[name] = Raw(
            values=values,
            time=time,
            unit=units[column],
            time_unit=time_unit,
            lines=rows.lines,
            lost=lost,
            about=rows.notes,
            read_as=way,
        )
    return result


def _way(
    table: Table, rows: Rows, read: dict[int, Numbers], units: dict[int, str], mapping: Mapping
) -> str:
    """Return how the table was read, in a few words: what the user may want to put right."""
    layout = table.layout
    signs = {".": "point", ",": "comma"}
    decimals = sorted({signs[each.decimal] for each in read.values() if each.decimal})
    behind = any(split_unit(layout.names[column])[1] for column in units)
    below = f"in line {mapping.units_line}" if mapping.units_line else "below the header"
    said = f"units {'behind the names' if behind else below}" if any(units.values()) else "no units"
    lost = sum(int(np.count_nonzero(np.isnan(each.values))) for each in read.values())
    time = f"time '{mapping.time}'" if mapping.time else f"{mapping.rate} Hz"
    return (
        f"{table.encoding}, separator {shown(layout.separator)}, decimal sign "
        f"{' and '.join(decimals) or 'none'}, header in line {layout.header}, {said}, "
        f"{time}, {len(rows.lines)} rows in lines {rows.lines[0]} to {rows.lines[-1]}, "
        f"{lost} cells without a number"
    )


def _numbers(
    cells: dict[int, tuple[str, ...]], rows: Rows, layout: Layout, mapping: Mapping
) -> dict[int, Numbers]:
    """Return the columns as numbers. BenchError where much of one is text.

    Or where rows of whole numbers are longer than the header between commas: '1,5,' may be 1.5.
    """
    doubtful = rows.longer and layout.separator == "," and mapping.decimal is None
    if doubtful and not any({*OTHER} & {*"".join(texts)} for texts in cells.values()):
        raise BenchError(
            f"line {rows.lines[0]} has more cells than the header in line {layout.header} and "
            "whole numbers only: commas may be decimal signs; say `decimal` in the mapping"
        )
    read = read_columns(
        [(layout.names[column], texts) for column, texts in cells.items()],
        rows.lines,
        mapping.decimal,
        mapping.thousands,
        mapping.missing,
    )
    for (column, texts), numbers in zip(cells.items(), read, strict=True):
        _check_share(numbers.foreign, texts, rows, layout.names[column], "is not a number")
    return dict(zip(cells, read, strict=True))


def _check_share(
    foreign: Sequence[int], cells: Sequence[str], rows: Rows, name: str, what: str
) -> None:
    """Raise BenchError where more than a tenth of a column's filled cells are foreign texts."""
    filled = sum(1 for cell in cells if not is_missing(cell)) if foreign else 0
    if len(foreign) > LOST_SHARE * filled:
        row = foreign[0]
        raise BenchError(
            f"line {rows.lines[row]}: {name} {quoted(cells[row])} {what}, nor are "
            f"{len(foreign) - 1} more of {filled} cells: see `missing`, `decimal` and `thousands` "
            "in the mapping"
        )


def _dates(cells: tuple[str, ...], rows: Rows, name: str, mapping: Mapping) -> np.ndarray:
    """Return dates or times of day in the mapping's unit of time, from the first one."""
    try:
        found = instants(cells, mapping.time_format)
    except BenchError as error:
        raise BenchError(f"line {rows.lines[0]}, '{name}': {error}") from None
    _check_share(found.foreign, cells, rows, name, "is not a time as the others")
    return found.time / factor(mapping.time_unit, "s", "time_unit")


def _counted(read: Numbers, rows: Rows, name: str, time_unit: str, mapping: Mapping) -> np.ndarray:
    """Return numbers as time in their own unit; BenchError where they would be in a far future."""
    unit = time_unit if time_unit and "time_unit" not in mapping.model_fields_set else ""
    seconds = np.abs(read.values) * factor(unit or mapping.time_unit, "s", "time_unit")
    late = np.flatnonzero(seconds > LATEST_S)
    if len(late):
        raise BenchError(
            f"line {rows.lines[late[0]]}: {name} '{read.texts[late[0]]}' cannot be in "
            f"{unit or mapping.time_unit}: say `time_unit` (or `time_format`) in the mapping"
        )
    return counted(read.texts, read.values)


def _units(table: Table, rows: Rows, mapping: Mapping) -> dict[int, str]:
    """Return the unit of each column asked for, '' where none is seen.

    From the line that the mapping names; else from behind the name; else from the first row of
    texts below the header that has a unit in one of these columns.
    """
    columns = set(table.columns.values())
    if mapping.units_line is not None:
        if mapping.units_line > len(table.lines):
            raise BenchError(f"line {mapping.units_line}, the `units_line`, is behind the end")
        line = row_of(table.lines[mapping.units_line - 1], table.layout.separator)
        return {column: _bare(line[column]) if column < len(line) else "" for column in columns}
    below = next(
        (row for row in rows.texts if any(is_unit(_bare(row[column])) for column in columns)), ()
    )
    units = {}
    for column in columns:
        behind = split_unit(table.layout.names[column])[1]
        units[column] = behind or (_bare(below[column]) if below else "")
    return units


def _bare(unit: str) -> str:
    return plain(unit).strip("[]() ")


def _lost(cells: Sequence[str], read: Numbers, rows: Rows) -> str:
    """Return the first text that is no number, or an empty cell, and its line; '' for none."""
    lost = np.flatnonzero(np.isnan(read.values) & ~rows.bad).tolist()
    if not lost:
        return ""
    row = next((row for row in lost if cells[row].strip()), lost[0])
    text = quoted(cells[row]) if cells[row].strip() else "an empty cell"
    return f"{text} first in line {rows.lines[row]}"
