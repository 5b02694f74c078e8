"""Which samples of a channel can be measured at all: sentinels and broken digits are told as gaps.

A sample beyond the channel's limits (``channels.LIMITS``) was not measured. Nor was one that stands
far from all others and has a value that loggers write for "no value".
"""

from __future__ import annotations

from collections.abc import Iterable

import numpy as np

from steering_core.errors import BenchError
from steering_diagnosis.data.channels import CHANNELS

SENTINELS = frozenset(
    sign * value
    for sign in (1.0, -1.0)
    for value in (
        *(99.0, 999.0, 9999.0, 99999.0, 999999.0, 9999999.0),
        *(99.99, 999.9, 999.99, 9999.9, 9999.99, 999.25, 6999.0, 8888.0),
        *(32767.0, 32768.0, 65534.0, 65535.0, 2147483647.0, 2147483648.0, 4294967295.0),
    )
)
"""Numbers that loggers write for no value, and the ends of whole numbers of 16 and 32 bits."""

FAR = 1.0
"""Times the span of all other values: so far from them stands what is no value."""

MOST_BEYOND = 0.1
"""Share of samples beyond the limits from which the unit or the scale is wrong, not a sample."""


def without(raw: np.ndarray, missing: Iterable[str | float]) -> np.ndarray:
    """Return the file's values (n,) with NaN for the numbers that stand for no value."""
    numbers = [float(each) for each in missing if not isinstance(each, str)]
    return np.where(np.isin(raw, numbers), np.nan, raw) if numbers else raw


def measured(
    name: str, raw: np.ndarray, si: np.ndarray, to_si: float, unit: str, lines: np.ndarray | None
) -> tuple[np.ndarray, list[str]]:
    """Return which samples can be measured, (n,) bool, non-numbers included; and what to say.

    raw: (n,) as in the file; si: (n,) in SI; to_si: from ``unit`` to SI; lines: (n,) in a text
    file. BenchError where all are beyond the limits, or more than a tenth and not one number.
    """
    channel = CHANNELS[name]
    finite = np.isfinite(raw)
    beyond = finite & ~((si >= channel.low) & (si <= channel.high))
    kept, notes = ~beyond, []
    if beyond.any():
        limits = f"{channel.low / to_si:.4g} to {channel.high / to_si:.4g} {unit}"
        told = (
            f"{np.count_nonzero(beyond)} of {len(raw)} samples are beyond {limits} "
            f"(first: {_first(raw, beyond, lines)})"
        )
        values = np.unique(raw[beyond])
        share = np.count_nonzero(beyond) / np.count_nonzero(finite)
        if share == 1.0 or (len(values) > 1 and share > MOST_BEYOND):
            raise BenchError(
                f"{name}: {told}: are `unit` and `scale` in the mapping right? What stands for no "
                "value is named with `missing`, as `missing: [-9999]`"
            )
        notes.append(f"{told}: left out{_hint(values)}")
    for value in _apart(raw[finite & kept]):
        at = raw == value
        kept &= ~at
        notes.append(
            f"{np.count_nonzero(at)} of {len(raw)} samples are {value:g}, far from all others "
            f"(first: {_first(raw, at, lines)}): left out{_hint(np.array([value]))}"
        )
    return kept, notes


def _first(raw: np.ndarray, at: np.ndarray, lines: np.ndarray | None) -> str:
    k = int(np.flatnonzero(at)[0])
    place = f"sample {k + 1}" if lines is None else f"line {lines[k]}"
    return f"{raw[k]:g} in {place}"


def _hint(values: np.ndarray) -> str:
    """Return what to write in the mapping where one number stands for no value."""
    return f", as `missing: [{values[0]:g}]` would" if len(values) == 1 else ""


def _apart(values: np.ndarray) -> list[float]:
    """Return the sentinels at either end of ``values`` that stand far from all that are none."""
    different = np.unique(values)
    is_sentinel = np.isin(different, list(SENTINELS))
    others = different[~is_sentinel]
    if len(others) < 2:
        return []
    low, high = others[0], others[-1]
    reach = FAR * (high - low)
    far = is_sentinel & ((different < low - reach) | (different > high + reach))
    return [float(value) for value in different[far]]
