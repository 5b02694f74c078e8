"""All constants that decide something, each with its unit and its reason.

``examples/sensitivity.py`` prints what halving and doubling them does to the records of the
examples; docs/diagnosis_library.md has its table.
"""

from __future__ import annotations

from dataclasses import dataclass, field, fields, replace
from typing import Any

from balance_diagnosis.errors import BalanceError


def _constant(value: float, unit: str, reason: str) -> Any:
    return field(default=value, metadata={"unit": unit, "reason": reason})


@dataclass(frozen=True)
class Constants:
    """The criterion's constants; ``table`` gives them with units and reasons."""

    facts: float = _constant(
        100.0, "1", "K: independent facts on the form of the model that a diagnosis can hold"
    )
    expected: float = _constant(1.0, "causes", "causes expected; prior of each: expected / causes")
    slab: float = _constant(2.0, "typical sizes", "standard deviation of the size of a named cause")
    spike: float = _constant(
        0.1, "typical sizes", "standard deviation of every other cause: all are a little wrong"
    )
    sure: float = _constant(0.95, "probability", "from here a thing is said without a perhaps")
    material: float = _constant(
        0.2, "share of the error", "predictable rest from which the catalogue is incomplete"
    )
    band: float = _constant(0.99, "share of the error", "energy below the band that is judged")
    features: float = _constant(40.0, "functions", "of each group of smooth functions of states")
    typical: float = _constant(
        0.05, "share of an output's deviation", "change that a cause of typical size makes"
    )
    visible: float = _constant(3.0, "nats", "expected information from which a cause is decidable")

    def scaled(self, name: str, factor: float) -> Constants:
        """Return a copy with one constant multiplied, kept below 1 where it is a share of one."""
        if name not in {f.name for f in fields(self)}:
            raise BalanceError(f"there is no constant '{name}'; see balance_diagnosis.constants")
        value = getattr(self, name)
        if name in ("sure", "band"):
            return replace(self, **{name: 1.0 - (1.0 - value) / factor})
        return replace(self, **{name: value * factor})

    def table(self) -> list[dict[str, Any]]:
        """Return name, value, unit and reason of each constant."""
        return [
            {"name": f.name, "value": getattr(self, f.name), **f.metadata} for f in fields(self)
        ]


DEFAULT = Constants()

ROWS = 4000
"""Most rows of all outputs together. Costs time; more decide nothing on slow errors."""

LEAST_ROWS = 250
"""Rows that a record's output keeps at least, however slow its error."""

MOST_CAUSES = 5
"""Causes at once. A record that seems to need more has another form."""
