"""The time that a MAT file keeps beside its signals, in the layouts that tools write."""

from __future__ import annotations

from collections.abc import Collection, Mapping
from typing import Any

import numpy as np

from steering_diagnosis.data.foreign.matlab.leaf import About, Clock
from steering_diagnosis.data.foreign.matlab.values import leaf, number, text

TIMES = ("Time", "time", "CompressedTime")
"""Fields of a structure that are the time of the others, where they rise."""

SCALES = {
    "weeks": 604800.0,
    "days": 86400.0,
    "hours": 3600.0,
    "minutes": 60.0,
    "seconds": 1.0,
    "milliseconds": 1e-3,
    "microseconds": 1e-6,
    "nanoseconds": 1e-9,
}
"""Time units of a timeseries, in s (documentation of MATLAB, tsdata.timemetadata)."""

MOST_SAMPLES = 1 << 31


def beside(
    fields: Mapping[str, Any], about_time: Mapping[str, Any], names: Collection[str]
) -> Clock | None:
    """Return the clock that lies among the fields of a structure; None where there is none.

    That of Simulink's structures with time and timeseries, and of any structure made like them.
    about_time: the properties of a timeseries' TimeInfo, which may have its time.
    """
    scale = SCALES.get(text(about_time.get("Units")))
    for name, value in [*((name, fields.get(name)) for name in names), *about_time.items()]:
        if name not in names or value is None:
            continue
        found = leaf(value, About())
        if found.array is None or not found.is_vector:
            continue
        times = np.squeeze(found.array).astype(np.float64)
        if name == "CompressedTime" and len(times) == 3:
            return _even(float(times[0]), float(times[1]), float(times[2]), scale)
        if _rises(times):
            return Clock(times, found.scale or scale)
    start, step, count = (number(about_time.get(key)) for key in ("Start", "Increment", "Length"))
    if start is None or step is None or count is None:
        return None
    return _even(start, step, count, scale)


def _even(start: float, step: float, count: float, scale: float | None) -> Clock | None:
    if not (step > 0.0 and 1.0 < count < MOST_SAMPLES):
        return None
    return Clock(start + step * np.arange(int(count)), scale)


def _rises(times: np.ndarray) -> bool:
    finite = times[np.isfinite(times)]
    return len(finite) > 1 and bool(np.all(np.diff(finite) >= 0.0)) and finite[-1] > finite[0]
