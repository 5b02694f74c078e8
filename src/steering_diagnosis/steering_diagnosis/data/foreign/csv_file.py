"""Comma, semicolon or tab separated text files."""

from __future__ import annotations

import csv
from pathlib import Path
from typing import Any

import numpy as np

from steering_core.errors import BenchError
from steering_core.naming import unknown
from steering_diagnosis.data.foreign.raw import Raw
from steering_diagnosis.data.mapping import Mapping


def read_csv(path: Path, mapping: Mapping) -> dict[str, Raw]:
    """Read comma, semicolon or tab separated columns below a header, units in a line or not."""
    import pandas

    separator, decimal, has_units = _csv_style(path)
    try:
        table = pandas.read_csv(
            path,
            sep=separator,
            decimal=decimal,
            comment="#",
            skipinitialspace=True,
            low_memory=False,
            skiprows=[1] if has_units else None,
            encoding="utf-8-sig",
        )
        heads = pandas.read_csv(path, sep=separator, comment="#", nrows=1, dtype=str)
    except (ValueError, OSError) as error:
        raise BenchError(f"'{path}' cannot be read as CSV: {error}") from None
    table.columns = [str(name).strip() for name in table.columns]
    units = dict(zip(table.columns, heads.iloc[0], strict=False)) if has_units else {}
    time = mapping.time
    sources = [channel.source for channel in mapping.channels.values()]
    names = sources + ([time] if time else [])
    for name in names:
        if name not in table.columns:
            raise BenchError(f"'{path}': {unknown('column', name, table.columns)}")
    columns = {name: _numbers(table[name], name, path) for name in set(names)}
    instants = columns[time] if time else None
    return {
        name: Raw(
            columns[channel.source], instants, str(units.get(channel.source, "")).strip(" []")
        )
        for name, channel in mapping.channels.items()
    }


def _csv_style(path: Path) -> tuple[str, str, bool]:
    """Return separator, decimal sign, and whether a line of units follows the header."""
    with path.open(encoding="utf-8-sig", errors="replace", newline="") as file:
        lines = [line for line in (file.readline() for _ in range(60)) if line.strip()]
    lines = [line for line in lines if not line.startswith("#")]
    if len(lines) < 2:
        raise BenchError(f"'{path}': no numbers below a header")
    try:
        separator = csv.Sniffer().sniff(lines[0], delimiters=",;\t|").delimiter
    except csv.Error:
        separator = ","
    decimal = "," if separator != "," and "," in lines[-1] else "."
    cells = [cell.strip().strip('"') for cell in lines[1].split(separator)]
    return separator, decimal, all(not _is_number(cell, decimal) for cell in cells if cell)


def _is_number(cell: str, decimal: str) -> bool:
    try:
        float(cell.replace(decimal, "."))
    except ValueError:
        return False
    return True


def _numbers(column: Any, name: str, path: Path) -> np.ndarray:
    """Return a column as float64; empty cells are NaN, other texts an error with their line."""
    try:
        return column.to_numpy(dtype=np.float64, na_value=np.nan)
    except (ValueError, TypeError):
        texts = column.astype(str)
        for line, text in enumerate(texts, start=2):
            if not _is_number(text, ".") and text not in ("", "nan"):
                raise BenchError(
                    f"'{path}', about line {line}: {name} '{text}' is not a number"
                ) from None
        raise BenchError(f"'{path}': column '{name}' does not hold numbers") from None
