"""Signals of another shape than what they should follow: magnitudes, shifted, AC-coupled."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy import signal

from steering_diagnosis.data.channels import MEASURED
from steering_diagnosis.data.record import Record
from steering_diagnosis.steering.channel_faults import Suspicion
from steering_diagnosis.steering.relations import (
    RELATIONS,
    STEP_S,
    Relation,
    Signals,
    correlation,
)

MATCHES = 0.97
"""Correlation that another shape has to reach."""
BETTER = 0.2
"""What it leaves, one less the correlation, over what the plain comparison leaves."""

NONE_BELOW, BOTH_WAYS = 0.02, 0.1
"""Of its largest value: a magnitude goes below zero no further; and what it should follow goes both
ways by more."""

CLOSE = 0.99
"""Correlation from which a shift is too short beside the motion to be told."""

LEAST_SHIFT_S, LONGEST_SHIFT_S = 0.08, 2.0
"""Longer than any sensor's delay of the catalogue (50 ms); further is not looked for."""

TIMES_S = (0.03, 0.1, 0.3, 1.0, 3.0)
"""Time constants of AC coupling that are tried."""


@dataclass(frozen=True)
class Pair:
    """Two signals that should be alike, (m,) each, and which channels each of them is made of."""

    relation: Relation
    values: np.ndarray
    expected: np.ndarray

    @property
    def alike(self) -> float:
        """How alike they are as they stand."""
        return correlation(self.values, self.expected)

    @property
    def single(self) -> bool:
        """Whether either side is one channel."""
        return len(self.relation.needs) == 1

    def better(self, found: float) -> bool:
        """Return whether a correlation of another shape is clearly the better one."""
        return found > MATCHES and 1.0 - found < BETTER * (1.0 - max(self.alike, 0.0))


def shapes(record: Record, s: Signals) -> list[Suspicion]:
    """Return the channels whose shape is another one's, one suspicion each."""
    pairs = [
        Pair(r, s[r.name], r.of(s, record.nominal))
        for r in RELATIONS
        if r.present(record, s) and r.usable(s, record.nominal) and not r.level
    ]
    timed = [pair for pair in pairs if pair.relation.shaped]
    found: dict[tuple[str, ...], Suspicion] = {}
    for seen in (*map(_magnitude, pairs), *map(_ac_coupled, timed)):
        if seen and not any(set(seen.channels) & set(known) for known in found):
            found[seen.channels] = seen
    return list(found.values()) or _shifted(timed)


def _magnitude(pair: Pair) -> Suspicion | None:
    sides = [(pair.values, pair.expected, pair.relation.name)]
    if pair.single:
        sides.append((pair.expected, pair.values, pair.relation.needs[0]))
    for one, other, name in sides:
        low = -one.min() < NONE_BELOW * one.max()
        both = min(other.max(), -other.min()) > BOTH_WAYS * np.abs(other).max()
        if low and both and name in MEASURED and pair.better(correlation(one, np.abs(other))):
            partner = " and ".join(n for n in pair.relation.members if n != name)
            text = (
                f"{name} seems to be a magnitude without its sign: it is never negative and goes "
                f"with the magnitude of {partner} (correlation "
                f"{correlation(one, np.abs(other)):.2f}, plain {pair.alike:.2f})"
            )
            return Suspicion(text, (name,))
    return None


def _ac_coupled(pair: Pair) -> Suspicion | None:
    sides = [(pair.values, pair.expected, pair.relation.name)]
    if pair.single:
        sides.append((pair.expected, pair.values, pair.relation.needs[0]))
    best: tuple[float, float, str] = (0.0, 0.0, "")
    for one, other, name in sides:
        for time in TIMES_S:
            best = max(best, (correlation(one, _coupled(other, time)), time, name))
    alike, time, name = best
    if name not in MEASURED or not pair.better(alike):
        return None
    partner = " and ".join(n for n in pair.relation.members if n != name)
    text = (
        f"{name} seems to be AC-coupled, with about {time:g} s: so it goes with {partner} "
        f"(correlation {alike:.2f}, plain {pair.alike:.2f})"
    )
    return Suspicion(text, (name,))


def _coupled(values: np.ndarray, time: float) -> np.ndarray:
    """Return what a first-order high-pass leaves of a signal, (m,)."""
    keep = time / (time + STEP_S)
    return np.asarray(signal.lfilter([keep, -keep], [1.0, -keep], values - values[0]))


def _shifted(pairs: list[Pair]) -> list[Suspicion]:
    """Return the channels that are late or early in every comparison that shows time."""
    lags = [(pair, *_lag(pair)) for pair in pairs]
    apart = [(pair, lag, alike) for pair, lag, alike in lags if lag]
    if not apart:
        return []
    together = {
        n
        for pair, lag, _ in lags
        if not lag and pair.alike > MATCHES
        for n in pair.relation.members
    }
    pair, lag, alike = max(apart, key=lambda found: found[2])
    members = [n for n in pair.relation.members if n in MEASURED]
    blamed = [n for n in members if n not in together] or members
    text = (
        f"{pair.relation.name} and {' and '.join(pair.relation.needs)} are {abs(lag):.2f} s apart "
        f"(correlation {alike:.2f}, plain {pair.alike:.2f}), {pair.relation.name} the "
        f"{'later' if lag > 0.0 else 'earlier'}: a clock or a trigger"
    )
    return [Suspicion(text, tuple(blamed))]


def _lag(pair: Pair) -> tuple[float, float]:
    """Return by how much the values are late [s], 0 if that is not clear, and the correlation."""
    if pair.alike > CLOSE:
        return 0.0, pair.alike
    most = int(LONGEST_SHIFT_S / STEP_S)
    n = len(pair.values)
    found: list[tuple[float, int]] = []
    for k in range(-most, most + 1):
        if n - abs(k) > n // 2:
            late, early = max(k, 0), max(-k, 0)
            alike = correlation(pair.values[late : n - early], pair.expected[early : n - late])
            found.append((alike, k))
    alike, k = max(found, key=lambda f: (round(f[0], 3), -abs(f[1])), default=(0.0, 0))
    if abs(k) * STEP_S < LEAST_SHIFT_S or not pair.better(alike):
        return 0.0, alike
    return k * STEP_S, alike
