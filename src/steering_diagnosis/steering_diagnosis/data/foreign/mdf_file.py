"""MDF files, version 4 and 3."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from steering_core.errors import BenchError
from steering_core.naming import unknown
from steering_diagnosis.data.foreign.raw import Raw
from steering_diagnosis.data.mapping import Mapping


def read_mdf(path: Path, mapping: Mapping) -> dict[str, Raw]:
    """Read channels of an MDF file, each with the clock of its own group."""
    from asammdf import MDF

    try:
        file = MDF(path)
    except Exception as error:
        raise BenchError(f"'{path}' cannot be read as MDF: {error}") from None
    found = {}
    with file:
        for channel_name, channel in mapping.channels.items():
            name, group = channel.source, channel.group
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
            found[channel_name] = Raw(
                values.astype(np.float64), np.asarray(signal.timestamps), str(signal.unit or "")
            )
    return found
