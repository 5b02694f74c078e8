"""The channels that a mapping names in a MAT file."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from steering_core.errors import BenchError
from steering_diagnosis.data.foreign.matlab.find import Vector, Vectors
from steering_diagnosis.data.foreign.matlab.load import load
from steering_diagnosis.data.foreign.matlab.tree import walk
from steering_diagnosis.data.foreign.raw import Raw
from steering_diagnosis.data.mapping import MappedChannel, Mapping
from steering_diagnosis.data.units import factor, same

AGREEING = 1e-3
"""Share of a sampling period by which two clocks of one channel may differ."""

DATE_NUMBERS, DATE_STEP = (6e5, 9e5), 1e-5
"""Days of MATLAB's datenum in the years 1642 to 2464; no rig samples in steps of 10 us."""


def read_matlab(path: Path, mapping: Mapping) -> dict[str, Raw]:
    """Read channels by MATLAB's own addresses, or by the names that the file gives them.

    A channel has the time that its mapping names, else that which the file keeps with it
    (timeseries, timetables, structures with time, ControlDesk), else the mapping's common one.
    BenchError lists the vectors of the file where a name is not among them.
    """
    times = {mapping.time} | {channel.time for channel in mapping.channels.values()} - {""}
    names = {channel.source for channel in mapping.channels.values()} | times
    vectors = _vectors(path, names - {""})
    return {
        name: _raw(path, mapping, channel, vectors) for name, channel in mapping.channels.items()
    }


def _vectors(path: Path, names: set[str]) -> Vectors:
    """Return the file's vectors; the whole file is read only where a name needs it."""
    some = Vectors(dict(walk(load(path, names))), f"'{path}'")
    if all(some.has_address(name) for name in names):
        return some
    return Vectors(dict(walk(load(path))), f"'{path}'")


def _raw(path: Path, mapping: Mapping, channel: MappedChannel, vectors: Vectors) -> Raw:
    name = channel.source
    vector = vectors[name]
    times = _times(path, mapping, channel, vector, vectors)
    return Raw(vector.values, times, vector.unit)


def _times(
    path: Path, mapping: Mapping, channel: MappedChannel, vector: Vector, vectors: Vectors
) -> np.ndarray | None:
    """Return the instants of a channel in the mapping's unit of time, None without any."""
    asked = channel.time or mapping.time
    own = None if mapping.rate or channel.time else vector.clock
    if not asked:
        return None if own is None else _in_unit(own.times, own.scale, mapping)
    named = vectors[asked]
    _check_days(path, asked, named, mapping)
    given = _in_unit(named.values, named.scale, mapping)
    if len(given) != len(vector.values):
        if own is not None:
            return _in_unit(own.times, own.scale, mapping)
        raise BenchError(
            f"'{path}': '{channel.source}' has {len(vector.values)} values, '{asked}' "
            f"{len(given)}: name the channel's own time with 'time'"
        )
    if own is not None:
        kept = _in_unit(own.times, own.scale, mapping)
        period = float(np.nanmedian(np.abs(np.diff(given)))) if len(given) > 1 else 0.0
        apart = float(np.nanmax(np.abs(kept - given)))
        if not apart <= AGREEING * period:
            raise BenchError(
                f"'{path}': '{channel.source}' has a time of its own in the file, which is "
                f"{apart:.3g} {mapping.time_unit} away from '{asked}': say which with the "
                "channel's 'time', or leave the common 'time' out"
            )
    return given


def _check_days(path: Path, name: str, time: Vector, mapping: Mapping) -> None:
    """Refuse date numbers, which are days, where the mapping says they are something shorter."""
    least, most = DATE_NUMBERS
    steps = np.abs(np.diff(time.values))
    within = time.scale is None and np.all((time.values > least) & (time.values < most))
    if within and not same(mapping.time_unit, "d", "s") and float(np.median(steps)) < DATE_STEP:
        raise BenchError(
            f"'{path}': '{name}' looks like MATLAB's date numbers, which are days: "
            f"give 'time_unit: d', not '{mapping.time_unit}'"
        )


def _in_unit(times: np.ndarray, scale: float | None, mapping: Mapping) -> np.ndarray:
    """Return instants in the mapping's unit, in which they are where the file says none."""
    if scale is None:
        return times
    return times * (scale / factor(mapping.time_unit, "s", "time_unit"))
