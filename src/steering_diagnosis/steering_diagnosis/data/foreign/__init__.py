"""Files of other tools as raw channels: CSV, MATLAB and MDF4. One reader by file ending."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

from steering_core.errors import BenchError
from steering_core.naming import unknown
from steering_diagnosis.data.foreign.csv_table import read_csv
from steering_diagnosis.data.foreign.matlab import read_matlab
from steering_diagnosis.data.foreign.mdf_file import read_mdf
from steering_diagnosis.data.foreign.raw import Raw, check_own
from steering_diagnosis.data.mapping import Mapping

__all__ = ["READERS", "TABLES", "Raw", "read_foreign"]

TABLES = frozenset((".csv", ".tsv", ".txt", ".lvm", ".gz"))
"""Endings of text tables; what is compressed with gzip is taken for one."""

READERS: dict[str, Callable[[Path, Mapping], dict[str, Raw]]] = {
    **dict.fromkeys(sorted(TABLES), read_csv),
    ".mat": read_matlab,
    ".mf4": read_mdf,
    ".mdf": read_mdf,
    ".dat": read_mdf,
}
"""File ending to reader. Register a new one here, and only here."""


def read_foreign(path: Path, mapping: Mapping) -> dict[str, Raw]:
    """Return the raw channels of a file by the bench's names, as ``mapping`` finds them in it.

    BenchError names the file and what is missing in it.
    """
    reader = READERS.get(path.suffix.lower())
    if reader is None:
        raise BenchError(f"'{path}': {unknown('kind of file', path.suffix, READERS)}")
    if path.is_dir():
        raise BenchError(f"'{path}' is a folder: give the file in it")
    if not path.is_file():
        raise BenchError(f"there is no file '{path}'")
    for name, channel in mapping.channels.items():
        if channel.time and reader is not read_matlab:
            raise BenchError(f"'{path}': {name}: only channels of MATLAB files have a 'time'")
    found = reader(path, mapping)
    check_own(((n, c.source, c.place) for n, c in mapping.channels.items()), f"'{path}'")
    return found
