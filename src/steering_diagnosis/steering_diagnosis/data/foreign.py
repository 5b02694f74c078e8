"""Files of other tools as raw channels: CSV, MATLAB and MDF4. One reader by file ending."""

from __future__ import annotations

import csv
from collections.abc import Callable, Iterable
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from steering_core.errors import BenchError
from steering_core.naming import unknown


@dataclass(frozen=True, repr=False)
class Raw:
    """A channel as the file has it. time: (n,) in the file's own unit, None where it has none."""

    values: np.ndarray
    time: np.ndarray | None = None
    unit: str = ""


Wanted = Iterable[tuple[str, int | None]]
"""Names of channels, each with its MDF group or None."""


def read_foreign(path: Path, wanted: Wanted, time: str) -> dict[str, Raw]:
    """Return the ``wanted`` channels of a file; ``time`` names its time column ("": none).

    BenchError names the file and what is missing in it.
    """
    reader = READERS.get(path.suffix.lower())
    if reader is None:
        raise BenchError(f"'{path}': {unknown('kind of file', path.suffix, READERS)}")
    if not path.is_file():
        raise BenchError(f"there is no file '{path}'")
    return reader(path, list(wanted), time)


def _read_csv(path: Path, wanted: list[tuple[str, int | None]], time: str) -> dict[str, Raw]:
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
    names = [name for name, _ in wanted] + ([time] if time else [])
    for name in names:
        if name not in table.columns:
            raise BenchError(f"'{path}': {unknown('column', name, table.columns)}")
    columns = {name: _numbers(table[name], name, path) for name in set(names)}
    instants = columns[time] if time else None
    return {
        name: Raw(columns[name], instants, str(units.get(name, "")).strip(" []"))
        for name, _ in wanted
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


def _read_matlab(path: Path, wanted: list[tuple[str, int | None]], time: str) -> dict[str, Raw]:
    """Read vectors of a MAT file up to version 7; names with dots look into structures."""
    from scipy.io import loadmat

    try:
        content = loadmat(path, squeeze_me=True, struct_as_record=False)
    except NotImplementedError:
        raise BenchError(f"'{path}' is a version 7.3 file: save it with '-v7' in MATLAB") from None
    except (ValueError, OSError, TypeError) as error:
        raise BenchError(f"'{path}' cannot be read as a MAT file: {error}") from None
    vectors = dict(_vectors("", {k: v for k, v in content.items() if not k.startswith("__")}))
    names = [name for name, _ in wanted]
    for name in [*names, time] if time else names:
        if name not in vectors:
            raise BenchError(f"'{path}': {unknown('vector', name, vectors)}")
    instants = vectors[time] if time else None
    for name in names:
        if instants is not None and len(vectors[name]) != len(instants):
            raise BenchError(
                f"'{path}': '{name}' has {len(vectors[name])} values, '{time}' {len(instants)}"
            )
    return {name: Raw(vectors[name], instants) for name in names}


def _vectors(prefix: str, items: dict[str, Any]) -> Iterable[tuple[str, np.ndarray]]:
    for name, value in items.items():
        if hasattr(value, "_fieldnames"):
            fields = {field: getattr(value, field) for field in value._fieldnames}
            yield from _vectors(f"{prefix}{name}.", fields)
        elif isinstance(value, np.ndarray) and value.ndim == 1 and value.dtype.kind in "fiub":
            yield prefix + name, value.astype(np.float64)


def _read_mdf(path: Path, wanted: list[tuple[str, int | None]], time: str) -> dict[str, Raw]:
    """Read channels of an MDF file, each with the clock of its own group."""
    from asammdf import MDF

    try:
        file = MDF(path)
    except Exception as error:
        raise BenchError(f"'{path}' cannot be read as MDF: {error}") from None
    found = {}
    with file:
        for name, group in wanted:
            places = file.channels_db.get(name, ())
            if not places:
                raise BenchError(f"'{path}': {unknown('channel', name, file.channels_db)}")
            if len(places) > 1 and group is None:
                groups = ", ".join(str(place[0]) for place in places)
                raise BenchError(
                    f"'{path}': channel '{name}' occurs in groups {groups}: say which with 'group'"
                )
            signal = file.get(name, group=group)
            values = np.asarray(signal.samples)
            if values.ndim != 1 or values.dtype.kind not in "fiub":
                raise BenchError(f"'{path}': channel '{name}' does not hold plain numbers")
            found[name] = Raw(
                values.astype(np.float64), np.asarray(signal.timestamps), str(signal.unit or "")
            )
    return found


READERS: dict[str, Callable[[Path, list[tuple[str, int | None]], str], dict[str, Raw]]] = {
    ".csv": _read_csv,
    ".txt": _read_csv,
    ".mat": _read_matlab,
    ".mf4": _read_mdf,
    ".mdf": _read_mdf,
    ".dat": _read_mdf,
}
"""File ending to reader. Register a new one here, and only here."""
