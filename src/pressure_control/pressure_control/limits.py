"""Bounds for kernels: finite in, finite out."""

from __future__ import annotations

from steering_core.compiled import kernel


@kernel
def bounded(value: float, low: float, high: float) -> float:
    """Return ``value`` within low to high; not a number gives ``low``."""
    if value >= high:
        return high
    if value > low:
        return value
    return low
