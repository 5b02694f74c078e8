"""A figure that a benchmark gives, its target, and what is said of it."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any


@dataclass(frozen=True)
class Row:
    """One figure. ``at_least``, ``at_most``: its target, where there is one.

    A target about time is a ratio of two times of the same run: absolute speeds differ by three
    from machine to machine. ``digits``: significant ones, in tables and in the documentation; 0: a
    whole number.
    """

    name: str
    what: str
    unit: str = ""
    at_least: float | None = None
    at_most: float | None = None
    digits: int = 2

    @property
    def has_target(self) -> bool:
        """Return whether the figure is wanted to be above or below something."""
        return self.at_least is not None or self.at_most is not None

    @property
    def target(self) -> str:
        """Return the target in words, "" without one."""
        if self.at_least is not None:
            return f"at least {self.at_least:g}"
        return "" if self.at_most is None else f"at most {self.at_most:g}"

    def reached(self, value: float | None) -> bool | None:
        """Return whether ``value`` meets the target; None without a target or a value."""
        if value is None or not self.has_target:
            return None
        if self.at_least is not None:
            return value >= self.at_least
        return self.at_most is not None and value <= self.at_most

    def text(self, value: float | None) -> str:
        """Return the figure as it is written."""
        if value is None or not math.isfinite(value):
            return "-" if value is None else str(value)
        if value == 0.0 or not self.digits:
            return f"{value:.0f}"
        places = self.digits - 1 - math.floor(math.log10(abs(value)))
        return f"{round(value, places):.{max(places, 0)}f}"

    def entry(self, value: float | None) -> dict[str, Any]:
        """Return the figure as it stands in the JSON file."""
        found = None if value is None else float(value)
        return {
            "value": found,
            "text": self.text(found),
            "unit": self.unit,
            "target": self.target,
            "reached": self.reached(found),
        }


@dataclass(frozen=True)
class Benchmark:
    """A program ``benchmarks/NAME.py``. ``quick``: options of its smallest size, seconds long."""

    name: str
    about: str
    rows: tuple[Row, ...]
    quick: Mapping[str, Any] = field(default_factory=dict)
    ros: bool = True

    def row(self, name: str) -> Row:
        """Return a row by name; KeyError where there is none."""
        return {row.name: row for row in self.rows}[name]


def missed(entries: Mapping[str, Mapping[str, Any]]) -> list[str]:
    """Return "name value (target)" of each row below its target."""
    return [
        f"{name} {entry['text']} ({entry['target']})"
        for name, entry in entries.items()
        if entry["reached"] is False
    ]


def verdict(name: str, entries: Mapping[str, Mapping[str, Any]]) -> str:
    """Return the one line about all targets of a benchmark."""
    judged = [e for e in entries.values() if e["reached"] is not None]
    below = missed(entries)
    unmeasured = [n for n, e in entries.items() if e["target"] and e["reached"] is None]
    rest = f"; not measured in this size: {', '.join(unmeasured)}" if unmeasured else ""
    if below:
        return f"{name}: {len(below)} of {len(judged)} targets missed: {', '.join(below)}{rest}"
    return f"{name}: {len(judged)} of {len(judged)} targets met{rest}"
