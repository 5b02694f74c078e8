"""Writers of CSV, MDF4 and MATLAB files as rigs make them; each returns the mapping to its file."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any

import numpy as np

from steering_diagnosis.benchmark.doors.logger import Logger
from steering_diagnosis.benchmark.doors.rig_names import RIG_NAMES, in_rig_units, mapping

Channels = Mapping[str, np.ndarray]
DIALECTS = ((",", "."), (";", ","), ("\t", "."), (";", "."))
"""Separators with decimal signs."""

ALL_DIGITS = 9
"""Significant ones of a text file; finer than any converter."""

STAMP_DIGITS = 7
"""Behind the decimal sign of a stamp in seconds."""


def write_csv(file: Path, time: np.ndarray, channels: Channels, logger: Logger, way: int) -> None:
    """Write a text file. way: number of its dialect; with a line of units in every other one."""
    separator, decimal = DIALECTS[way % len(DIALECTS)]
    names = [RIG_NAMES[name].name for name in channels]
    lines = [separator.join(["t", *names])]
    if way % 2:
        lines.append(separator.join(["[s]", *(f"[{RIG_NAMES[name].unit}]" for name in channels)]))
    digits = logger.digits or ALL_DIGITS
    form = separator.join([f"%.{STAMP_DIGITS}f", *[f"%.{digits}g"] * len(names)])
    table = np.column_stack([time, *channels.values()])
    text = "\n".join(form % tuple(row) for row in table.tolist())
    file.write_text("\n".join([*lines, text.replace(".", decimal), ""]), encoding="utf-8")


def map_csv(system: str, channels: Channels, logger: Logger, way: int) -> dict[str, Any]:
    """Return the mapping to such a file."""
    return mapping(system, channels, time="t")


def write_mdf(file: Path, time: np.ndarray, channels: Channels, logger: Logger, way: int) -> None:
    """Write an MDF4 file: a group for each device; the rack's has a clock of its own."""
    from asammdf import MDF, Signal

    offset, drift = logger.other
    with MDF(version="4.10") as made:
        for device in dict.fromkeys(RIG_NAMES[name].device for name in channels):
            stamps = (time - offset) / (1.0 + drift) if device == "rack" else time
            made.append(
                [
                    Signal(values, stamps, unit=RIG_NAMES[name].unit, name=RIG_NAMES[name].name)
                    for name, values in channels.items()
                    if RIG_NAMES[name].device == device
                ],
                comment=device,
            )
        made.save(file, overwrite=True)


def map_mdf(system: str, channels: Channels, logger: Logger, way: int) -> dict[str, Any]:
    """Return the mapping to such a file."""
    found = mapping(system, channels)
    if logger.other == (0.0, 0.0):
        return found
    offset, drift = logger.other
    for name, channel in found["channels"].items():
        if RIG_NAMES[name].device == "rack":
            channel["clock"] = "rack"
    return found | {"clocks": {"rack": {"offset": offset, "drift": drift}}}


def write_matlab(
    file: Path, time: np.ndarray, channels: Channels, logger: Logger, way: int
) -> None:
    """Write a MATLAB file of version 5: vectors, or a structure of them."""
    from scipy.io import savemat

    vectors = {"t": time} | {RIG_NAMES[name].name: values for name, values in channels.items()}
    savemat(file, {"log": vectors} if way % 2 else vectors, oned_as="column")


def map_matlab(system: str, channels: Channels, logger: Logger, way: int) -> dict[str, Any]:
    """Return the mapping to such a file."""
    prefix = "log." if way % 2 else ""
    return mapping(system, channels, prefix, time=f"{prefix}t")


Write = Callable[[Path, np.ndarray, Channels, Logger, int], None]
Map = Callable[[str, Channels, Logger, int], dict[str, Any]]
WRITERS: Mapping[str, tuple[str, Write, Map]] = {
    "csv": (".csv", write_csv, map_csv),
    "mdf": (".mf4", write_mdf, map_mdf),
    "matlab": (".mat", write_matlab, map_matlab),
}
"""Door to file ending, writer and mapping. Add one here, and only here."""


def as_in_a_file(channels: Channels) -> dict[str, np.ndarray]:
    """Return SI channels in a rig's units."""
    return {name: in_rig_units(name, values) for name, values in channels.items()}
