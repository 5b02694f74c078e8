"""Does a gear oscillate by itself? A rig's operator stops such a run, and no case is made of it.

The phase of a self-excited oscillation follows from nothing that is measured, and what a small
change does to it is no sensitivity.
"""

from __future__ import annotations

from scipy import signal

from steering_diagnosis.benchmark.truth import states as s
from steering_diagnosis.benchmark.truth.run import Signals

ABOVE_HZ = 30.0
"""No manoeuvre moves a rack faster."""

SHARE = 0.1
"""Of the rack speed's energy above it, from which a gear sings."""


def sings(run: Signals) -> bool:
    """Return whether the rack oscillates by itself."""
    hz, power = signal.welch(run.true[:, s.RACK_SPEED_OUT], 1e3, nperseg=min(1000, len(run.true)))
    return bool(power[hz > ABOVE_HZ].sum() > SHARE * power.sum())
