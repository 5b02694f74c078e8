"""Which mistakes explain what is off in a record: undone, they put every relation right.

Every relation between channels is right, off (by a factor, a sign or an offset) or unclear. A
mistake is suspected where undoing it puts right what it touches, and breaks nothing.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from steering_core.parameters import ParameterSet
from steering_diagnosis.data.record import Record
from steering_diagnosis.steering.mistakes import Mistake, mistakes
from steering_diagnosis.steering.relations import (
    RELATIONS,
    STEP_S,
    Link,
    Signals,
    correlation,
    link,
)

NEAR = 1.3
"""Factor that a comparison may be off by beside a mistake's own. Friction moves that of the rack's
forces by 1.1 on clean records."""

MATCHES, BETTER = 0.97, 0.2
"""Correlation that a shape has to reach that was not there; and what it leaves, one less the
correlation, over what was left."""

WORSE = 0.01
"""Correlation that a relation may lose."""

EQUAL = 1.2
"""Rests of two explanations over each other within which they explain as well."""

FINEST = 1e-3
"""Rest below which a relation explains no better."""

LEAST_SHIFT_S, LONGEST_SHIFT_S = 0.08, 2.0
"""Longer than any sensor's delay of the catalogue (50 ms); further is not looked for."""

MOST = 4
"""Mistakes of one record that are looked for."""


@dataclass(frozen=True)
class Explained:
    """A mistake that explains what is off. before, after: a relation that it puts right."""

    mistake: Mistake
    fixed: int
    left: int
    rest: float
    before: Link
    after: Link

    @property
    def text(self) -> str:
        """Return what is suspected, with the evidence and what to do."""
        names = " and ".join(self.mistake.suspected)
        verb = "seem" if len(self.mistake.suspected) > 1 else "seems"
        return f"{names} {verb} to {self.mistake.told}: {self._evidence}; {self.mistake.advice}"

    @property
    def _evidence(self) -> str:
        relation = self.before.relation
        if self.before.state == "off" and not self.before.apart:
            own = relation.name in self.mistake.channels
            return self.before.evidence if own else f"{relation.name}: {self.before.evidence}"
        others = " and ".join(relation.needs)
        return (
            f"without that {relation.name} goes with {others} (correlation "
            f"{self.after.correlation:.3f}, as it is {self.before.correlation:.2f})"
        )


def explained(record: Record, signals: Signals) -> list[Explained]:
    """Return what explains the relations that are off, one mistake after the other.

    What explains equally well, nothing else being known, is returned as well.
    """
    s, found = dict(signals), []
    for _ in range(MOST):
        best = _best(record, s)
        if not best:
            break
        found += best
        s = dict(best[0].mistake.undo(s))
        for e in best[1:]:
            s = {n: x for n, x in s.items() if n not in e.mistake.channels}
    return found


def _best(record: Record, s: Signals) -> list[Explained]:
    before = [link(r, s, record.nominal) for r in RELATIONS if r.present(record, s)]
    if not any(x.open for x in before):
        return []
    lags = {k: lag for k, x in enumerate(before) if x.open and (lag := _lag(x, s, record.nominal))}
    tried = (_explained(m, before, s, record.nominal) for m in mistakes(record, s, before, lags))
    found = [e for e in tried if e is not None]
    found = [e for e in found if not e.left] or found
    most = max((e.fixed - e.left for e in found), default=0)
    found = sorted((e for e in found if e.fixed - e.left == most), key=lambda e: e.rest)
    kept: list[Explained] = []
    for e in found:
        known = {c for k in kept for c in (*k.mistake.suspected, *k.mistake.channels)}
        if e.rest <= EQUAL * found[0].rest and not known & set(e.mistake.channels):
            kept.append(e)
    return kept


def _explained(
    mistake: Mistake, before: list[Link], s: Signals, nominal: ParameterSet
) -> Explained | None:
    """Return what a mistake explains; None where it breaks something, or puts nothing right."""
    touched = [x for x in before if set(mistake.channels) & set(x.relation.members)]
    if not any(x.open for x in touched):
        return None
    undone, fixed, left = mistake.undo(s), list[tuple[Link, Link]](), 0
    for old in touched:
        new = link(old.relation, undone, nominal)
        if old.state == "right" and (
            new.state != "right" or new.correlation < old.correlation - WORSE
        ):
            return None
        if old.open and new.state == "right" and (_put_right(old, new) or _reshaped(old, new)):
            fixed.append((old, new))
        elif old.state == "off":
            left += 1
    if not fixed:
        return None
    # The geometric mean: the finest relation tells two factors apart.
    rest = float(np.exp(np.mean([np.log(max(new.rest, FINEST)) for _, new in fixed])))
    own = [pair for pair in fixed if pair[0].relation.name in mistake.channels]
    return Explained(mistake, len(fixed), left, rest, *(own or fixed)[0])


def _put_right(old: Link, new: Link) -> bool:
    sized = new.relation.within is not None
    return old.state == "off" and (not sized or 1.0 / NEAR < new.factor < NEAR)


def _reshaped(old: Link, new: Link) -> bool:
    """Return whether two signals are alike in time as they were not."""
    return _better(abs(old.correlation), new.correlation)


def _better(old: float, new: float) -> bool:
    return new > MATCHES and 1.0 - new < BETTER * (1.0 - old)


def _lag(found: Link, s: Signals, nominal: ParameterSet) -> float:
    """Return by how much a relation's name is late [s], 0 if that is not clear."""
    relation = found.relation
    if not relation.timed or not relation.usable(s, nominal):
        return 0.0
    values, expected = s[relation.name], relation.of(s, nominal)
    n, most = len(values), int(LONGEST_SHIFT_S / STEP_S)
    shifts: list[tuple[float, int]] = []
    for k in range(-most, most + 1):
        if n - abs(k) > n // 2:
            late, early = max(k, 0), max(-k, 0)
            alike = correlation(values[late : n - early], expected[early : n - late])
            shifts.append((abs(alike), k))
    alike, k = max(shifts, key=lambda f: (round(f[0], 3), -abs(f[1])), default=(0.0, 0))
    clear = abs(k) * STEP_S >= LEAST_SHIFT_S and _better(abs(found.correlation), alike)
    return k * STEP_S if clear else 0.0
