"""Named columns of numbers from a CSV file, with errors that name the file and the line."""

from __future__ import annotations

import csv
import math
from collections.abc import Sequence
from pathlib import Path

import numpy as np

from steering_core.naming import nearest


class CsvError(ValueError):
    """A file that is missing, unreadable, or holds something else than the wanted columns."""


def read_columns(
    path: str | Path, columns: Sequence[str], increasing: str | None = None
) -> dict[str, np.ndarray]:
    """Read the float64 ``columns`` of a comma separated file with one header line.

    The header names exactly ``columns``, in any order; empty lines and lines that start with ``#``
    are skipped. All numbers are finite, and those of the column ``increasing`` grow from line to
    line. Returns arrays of equal length, at least one number each. Raises CsvError.
    """
    lines = _lines(Path(path))
    if not lines:
        raise CsvError(f"{path}: the file is empty, expected a header '{','.join(columns)}'")
    header_line, header = lines[0]
    _check_header(header, columns, f"{path}, line {header_line}")
    if len(lines) == 1:
        raise CsvError(f"{path}: there are no numbers below the header")
    rows = [_numbers(cells, header, f"{path}, line {line}") for line, cells in lines[1:]]
    table = dict(zip(header, np.array(rows, dtype=np.float64).T.copy(), strict=True))
    if increasing is not None:
        _check_increasing(table[increasing], [line for line, _ in lines[1:]], increasing, path)
    return {name: table[name] for name in columns}


def _lines(path: Path) -> list[tuple[int, list[str]]]:
    """Return (line number, stripped cells) of every line that holds something."""
    try:
        with path.open(encoding="utf-8-sig", newline="") as file:
            reader = csv.reader(file)
            numbered = [(reader.line_num, [cell.strip() for cell in cells]) for cells in reader]
    except FileNotFoundError:
        raise CsvError(f"{path}: there is no such file") from None
    except (OSError, UnicodeDecodeError, csv.Error) as error:
        raise CsvError(f"{path}: cannot be read: {error}") from None
    return [(n, cells) for n, cells in numbered if any(cells) and not cells[0].startswith("#")]


def _check_header(header: list[str], columns: Sequence[str], where: str) -> None:
    for name in header:
        if name not in columns:
            expected = f"; expected {', '.join(columns)}"
            raise CsvError(f"{where}: unknown column '{name}'{nearest(name, columns) or expected}")
    for name in columns:
        if header.count(name) != 1:
            fault = "is missing" if name not in header else "is named twice"
            raise CsvError(f"{where}: column '{name}' {fault}")


def _numbers(cells: list[str], header: list[str], where: str) -> list[float]:
    if len(cells) != len(header):
        raise CsvError(f"{where}: {len(cells)} values for {len(header)} columns")
    return [_number(cell, name, where) for cell, name in zip(cells, header, strict=True)]


def _number(cell: str, name: str, where: str) -> float:
    try:
        number = float(cell)
    except ValueError:
        raise CsvError(f"{where}: {name} '{cell}' is not a number") from None
    if not math.isfinite(number):
        raise CsvError(f"{where}: {name} must be finite, got {cell}")
    return number


def _check_increasing(values: np.ndarray, lines: list[int], name: str, path: str | Path) -> None:
    for previous, value, line in zip(values, values[1:], lines[1:], strict=False):
        if not value > previous:
            raise CsvError(
                f"{path}, line {line}: {name} must increase, got {value:g} after {previous:g}"
            )
