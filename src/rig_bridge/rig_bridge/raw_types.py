"""Types of the raw numbers in a binary frame."""

from __future__ import annotations

from typing import Literal, NamedTuple

RawType = Literal["int16", "int32", "float32", "float64"]


class Raw(NamedTuple):
    """``code``: of the struct module. ``limits``: lowest and highest. ``whole``: integers."""

    code: str
    limits: tuple[float, float]
    whole: bool


_LARGEST_FLOAT32 = 3.4028234663852886e38
_LARGEST_FLOAT64 = 1.7976931348623157e308

RAW_TYPES: dict[str, Raw] = {
    "int16": Raw("h", (-(2.0**15) + 1.0, 2.0**15 - 1.0), True),
    "int32": Raw("i", (-(2.0**31) + 1.0, 2.0**31 - 1.0), True),
    "float32": Raw("f", (-_LARGEST_FLOAT32, _LARGEST_FLOAT32), False),
    "float64": Raw("d", (-_LARGEST_FLOAT64, _LARGEST_FLOAT64), False),
}
"""The most negative integer is left out: it says "no value" (see ``encoded`` and ``decoded``)."""


def encoded(kind: Raw, number: float) -> float | int:
    """Return what goes into the frame: rounded and limited; NaN is the most negative integer."""
    if not kind.whole:
        return number if number != number else min(max(number, kind.limits[0]), kind.limits[1])
    if number != number:
        return int(kind.limits[0]) - 1
    return round(min(max(number, kind.limits[0]), kind.limits[1]))


def decoded(kind: Raw, number: float | int) -> float:
    """Return the raw number of a frame; the most negative integer is NaN."""
    return float("nan") if kind.whole and number < kind.limits[0] else float(number)
