"""What looks wrong with a record itself, before any inference.

Each channel is looked at by itself, and then together with those that physics ties it to. Every
look gives its evidence and what to do; the kinds are listed in docs/diagnosis_model.md. A suspected
channel is left out rather than put right, and samples that say nothing are not judged.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import replace

import numpy as np
from scipy import signal

from steering_diagnosis.data.record import PERIOD_S, Record
from steering_diagnosis.steering.channel_faults import (
    Suspicion,
    clipped,
    copies,
    dead,
    jumping,
    lost,
    stuck,
    swinging,
)
from steering_diagnosis.steering.explained import explained
from steering_diagnosis.steering.relations import compared, informative
from steering_diagnosis.steering.smoothing import bridged

SEGMENT = 1000
FASTEST_HZ, LINE_HZ = 30.0, 3.0
"""No manoeuvre moves a rack faster; half the width of a line."""
SINGING = 0.1
"""Share of the rack speed's energy in one line above it, from which a gear sings."""


def suspicions(record: Record) -> list[Suspicion]:
    """Return what looks wrong with a record, before any inference."""
    found = lost(record)
    record = without(record, found)
    found += dead(record) + jumping(record) + swinging(record)
    found += copies(record, left_out(found))
    ends = clipped(record, left_out(found))
    signals = compared(record, left_out(found))
    clear = informative(signals, _samples(record, ends))
    found += [Suspicion(e.text, e.mistake.suspected) for e in explained(record, clear)]
    gone = left_out(found)
    signals = {name: values for name, values in signals.items() if name not in gone}
    found += [s for s in ends if s.about not in gone] + stuck(record, signals)
    return found + _singing(record, left_out(found))


def without(record: Record, found: list[Suspicion], further: Iterable[str] = ()) -> Record:
    """Return the record without suspected channels; samples that say nothing are not judged.

    further: channels that are left out as well.
    """
    gone = left_out(found) | set(further)
    channels = {name: v for name, v in record.channels.items() if name not in gone}
    for s in found:
        if s.lost and s.samples is not None and s.about in channels:
            channels[s.about] = np.where(s.samples, np.nan, channels[s.about])
    excluded = _samples(record, [s for s in found if not s.lost and not s.channels])
    if record.excluded is not None:
        excluded |= record.excluded
    return replace(record, channels=channels, excluded=excluded if excluded.any() else None)


def _samples(record: Record, found: list[Suspicion]) -> np.ndarray:
    """Return the samples that say nothing, (n,) bool."""
    where = np.zeros(len(record), bool)
    for s in found:
        if s.samples is not None:
            where |= s.samples
    return where


def left_out(found: list[Suspicion]) -> set[str]:
    """Return the channels that are suspected and therefore left out."""
    return {channel for s in found for channel in s.channels}


def _singing(record: Record, gone: set[str]) -> list[Suspicion]:
    """Find a gear that oscillates by itself: one line holds much of what its rack does."""
    if "rack_speed" not in record or "rack_speed" in gone:
        return []
    speed = bridged(record["rack_speed"])
    hz, power = signal.welch(speed, 1.0 / PERIOD_S, nperseg=min(SEGMENT, len(speed)))
    above = hz > FASTEST_HZ
    k = int(np.argmax(np.where(above, power, 0.0)))
    line = power[(np.abs(hz - hz[k]) <= LINE_HZ) & above].sum() / max(power.sum(), 1e-300)
    if line < SINGING:
        return []
    return [
        Suspicion(
            f"the gear oscillates by itself at {hz[k]:.0f} Hz: {line:.0%} of the rack speed's "
            "energy is there. No replay follows such an oscillation in phase; record a manoeuvre "
            "in which it is silent",
            (),
        )
    ]
