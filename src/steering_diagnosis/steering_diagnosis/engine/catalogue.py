"""The coordinates of the search: nuisances in standard deviations, hypotheses in typical sizes."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from steering_diagnosis.engine.evaluate import Call
from steering_diagnosis.engine.model import (
    Hypothesis,
    HypothesisParameter,
    Nuisance,
    Replay,
)

FURTHEST = 2.0
"""A nuisance stays within its tolerance, two standard deviations: beyond, it is a cause."""

PREFIX = "parameter:"
"""Of the hypothesis that a nominal parameter is wrong."""

Values = Mapping[str, np.ndarray]
"""Active hypotheses with their parameters' values, in the order of ``Hypothesis.parameters``."""


@dataclass(frozen=True)
class Catalogue:
    """Nuisances and hypotheses of a replay, wrong nominal parameters included."""

    nuisances: tuple[Nuisance, ...]
    hypotheses: Mapping[str, Hypothesis]

    @cached_property
    def deviation(self) -> np.ndarray:
        """Standard deviations of the nuisances, (p,)."""
        return np.array([0.5 * n.tolerance for n in self.nuisances])

    @cached_property
    def least(self) -> np.ndarray:
        """Lower ends of the nuisances' physical ranges [standard deviations], (p,)."""
        return (np.array([n.low - n.nominal for n in self.nuisances])) / self.deviation

    @cached_property
    def most(self) -> np.ndarray:
        """Upper ends of the nuisances' physical ranges [standard deviations], (p,)."""
        return (np.array([n.high - n.nominal for n in self.nuisances])) / self.deviation

    @cached_property
    def lowest(self) -> np.ndarray:
        """Least nuisances that a fit may take: of tolerance and physical range, (p,)."""
        return np.maximum(self.least, -FURTHEST)

    @cached_property
    def highest(self) -> np.ndarray:
        """Largest nuisances that a fit may take: of tolerance and physical range, (p,)."""
        return np.minimum(self.most, FURTHEST)

    def inside(self, z: np.ndarray) -> np.ndarray:
        """Return nuisances with what a step has rounded over their ends put back, (p,)."""
        return np.clip(z, self.lowest, self.highest)

    def step(self, z: np.ndarray, i: int, size: float) -> float:
        """Return a step of nuisance ``i`` for differences, the other way where no room is left."""
        return room_for(size, z[i], self.least[i], self.most[i])

    @cached_property
    def index(self) -> dict[str, int]:
        """Return the position of each nuisance."""
        return {n.name: i for i, n in enumerate(self.nuisances)}

    def nuisance_of(self, hypothesis: str) -> str | None:
        """Return the nuisance that the hypothesis ``parameter:...`` is about."""
        return hypothesis.removeprefix(PREFIX) if hypothesis.startswith(PREFIX) else None

    def replaced(self, hypotheses: Iterable[str]) -> list[int]:
        """Return the positions of the nuisances that these hypotheses replace."""
        names = {n for h in hypotheses for n in self.hypotheses[h].replaces}
        return sorted(self.index[n] for n in names if n in self.index)

    def call(self, z: np.ndarray, values: Values) -> Call:
        """Return the call for nuisances ``z`` [standard deviations] and active hypotheses.

        Every value that a replay is asked for is made here, within its physical range.
        """
        absolute = {
            n.name: _within(n.nominal + z[i] * self.deviation[i], n.low, n.high)
            for i, n in enumerate(self.nuisances)
            if z[i] != 0.0
        }
        effects = {}
        for name, value in values.items():
            nuisance = self.nuisance_of(name)
            parameters = self.hypotheses[name].parameters
            inside = [_within(v, p.low, p.high) for p, v in zip(parameters, value, strict=True)]
            given = {p.name: v - p.turned(v) for p, v in zip(parameters, inside, strict=True)}
            if nuisance is None:
                effects[name] = given
            else:
                absolute[nuisance] = given[nuisance]
        return Call(absolute, effects)


def catalogue(replay: Replay) -> Catalogue:
    """Return the replay's catalogue; toleranced parameters that no effect covers are hypotheses."""
    covered = {c for h in replay.hypotheses.values() for c in h.competes}
    hypotheses = dict(replay.hypotheses)
    balances = {o.name: o.balance for o in replay.outputs}
    for n in replay.nuisances:
        if n.name not in covered and n.tolerance > 0.0:
            hypotheses[PREFIX + n.name] = _wrong_parameter(n, next(iter(balances.values())))
    kept = tuple(n for n in replay.nuisances if n.tolerance > 0.0)
    return Catalogue(kept, hypotheses)


def _wrong_parameter(n: Nuisance, balance: str) -> Hypothesis:
    """Return the hypothesis that a nominal parameter is beyond its tolerance."""
    reach = 20.0 * n.tolerance
    low, high = n.nominal - reach, n.nominal + reach
    if n.nominal != 0.0 and abs(n.nominal) < reach:
        # A positive parameter stays positive.
        low, high = sorted((0.02 * n.nominal, n.nominal * (1.0 + reach / abs(n.nominal))))
    low, high = max(low, n.low), min(high, n.high)
    step = room_for(2.0 * n.tolerance, n.nominal, low, high)
    parameter = HypothesisParameter(n.name, n.unit, n.nominal, low, high, n.nominal + step)
    return Hypothesis(
        PREFIX + n.name,
        f"the nominal value of {n.name} is wrong",
        balance,
        (parameter,),
        competes=(n.name,),
        replaces=(n.name,),
    )


def room_for(step: float, value: float, low: float, high: float) -> float:
    """Return a step from ``value`` that ends in its range: the other way, or as far as it goes."""
    for taken in (step, -step):
        if low <= value + taken <= high:
            return taken
    up, down = high - value, low - value
    return up if up >= -down else down


def _within(value: float, low: float, high: float) -> float:
    return float(min(max(value, low), high))


def scale(p: HypothesisParameter) -> float:
    """Return the size of one unit of a hypothesis's coordinate."""
    size = abs(p.typical - p.neutral)
    return size if size > 0.0 else (abs(p.typical) or 0.1 * (p.high - p.low))


def scales(h: Hypothesis) -> np.ndarray:
    """Return the units of a hypothesis's coordinates, (k,)."""
    return np.array([scale(p) for p in h.parameters])


def bounds(h: Hypothesis) -> tuple[np.ndarray, np.ndarray]:
    """Return the lower and upper bounds of a hypothesis's parameters, (k,) each."""
    low, high = [p.low for p in h.parameters], [p.high for p in h.parameters]
    return np.array(low, float), np.array(high, float)
