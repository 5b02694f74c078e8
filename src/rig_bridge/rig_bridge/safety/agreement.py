"""Watches what signals must agree on, so that a reversed sign or a stuck actuator is found."""

from __future__ import annotations

from collections import deque
from collections.abc import Mapping
from math import exp

from rig_bridge.relations import RatePair, Relation
from rig_bridge.safety.faults import Fault, Kind
from rig_bridge.signals import MEASURED, PERIOD_S


class RelationWatch:
    """A linear relation; see ``relations.Relation``."""

    def __init__(self, name: str, relation: Relation) -> None:
        self.name = name
        self.relation = relation
        self.keep = exp(-PERIOD_S / relation.lag) if relation.lag > 0.0 else 0.0
        self.reset()

    def reset(self) -> None:
        """Forget the past."""
        self.lagged: dict[str, float] = {}
        self.count = 0

    def see(self, values: Mapping[str, float], steps: int = 1) -> Fault | None:
        """Take a tick's signals by name; return a confirmed disagreement."""
        rest = self.relation.constant
        for name, factor in self.relation.factors.items():
            rest += factor * self._followed(name, values[name], steps)
        self.count = self.count + 1 if abs(rest) > self.relation.tolerance else 0
        if self.count < self.relation.ticks:
            return None
        return Fault(
            Kind.DISAGREEMENT, self.name, f"{rest:+g}, at most {self.relation.tolerance:g}"
        )

    def _followed(self, name: str, value: float, steps: int) -> float:
        if name in MEASURED:
            return value
        last = self.lagged.get(name, value)
        self.lagged[name] = value + self.keep**steps * (last - value)
        return self.lagged[name]


class RateWatch:
    """A value and its rate; see ``relations.RatePair``. The mean of the rate is the trapezium's."""

    def __init__(self, name: str, pair: RatePair) -> None:
        self.name = name
        self.pair = pair
        self.reset()

    def reset(self) -> None:
        """Forget the past."""
        self.change = 0.0
        self.past: deque[tuple[float, float, float]] = deque(maxlen=self.pair.window)
        self.last: tuple[float, float] | None = None

    def see(self, values: Mapping[str, float], steps: int = 1) -> Fault | None:
        """Take a tick's signals by name; return a disagreement."""
        value, rate = values[self.pair.value], values[self.pair.rate]
        if self.last is not None:
            time = steps * PERIOD_S
            self.past.append((value - self.last[0], 0.5 * (rate + self.last[1]) * time, time))
        self.last = value, rate
        if len(self.past) < self.pair.window:
            return None
        changed, expected, time = (sum(column) for column in zip(*self.past, strict=True))
        away = (changed - expected) / time
        if abs(away) <= self.pair.tolerance:
            return None
        return Fault(Kind.DISAGREEMENT, self.name, f"{away:+g}, at most {self.pair.tolerance:g}")
