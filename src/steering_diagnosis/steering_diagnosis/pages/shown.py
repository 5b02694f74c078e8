"""How SI values look on a page: bar, degrees, millimetres, l/min, and plain words."""

from __future__ import annotations

import math

UNITS: dict[str, tuple[str, float]] = {
    "Pa": ("bar", 1e-5),
    "rad": ("deg", 180.0 / math.pi),
    "rad/s": ("deg/s", 180.0 / math.pi),
    "m": ("mm", 1e3),
    "m/s": ("mm/s", 1e3),
    "m3/s": ("l/min", 6e4),
    "s": ("ms", 1e3),
}
"""SI unit to the unit that is shown and its factor; other units are shown as they are."""


def unit(si: str) -> str:
    """Return the unit that stands for ``si`` on a page."""
    return UNITS.get(si, (si, 1.0))[0]


def scale(si: str) -> float:
    """Return the factor from ``si`` to the unit that is shown."""
    return UNITS.get(si, (si, 1.0))[1]


def number(value: float, si: str = "1") -> str:
    """Return a value in the shown unit with three digits, without the unit."""
    return f"{value * scale(si):.3g}"


def quantity(value: float, si: str) -> str:
    """Return a value with its unit."""
    name = unit(si)
    return number(value, si) + ("" if name == "1" else f" {name}")


def words(name: str) -> str:
    """Return a name such as ``rack_stribeck_friction`` in words."""
    return name.replace("_", " ").replace("parameter:", "parameter ")


def percent(share: float) -> str:
    """Return a share as a percentage."""
    return f"{100.0 * share:.0f} %"


def probability(p: float) -> str:
    """Return a p-value; below what a float holds it is no zero."""
    return f"{p:.2g}" if p > 0.0 else "below 1e-300"
