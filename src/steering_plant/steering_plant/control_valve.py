"""Opening of the pressure control valve: drilled holes uncovered by the spool."""

from __future__ import annotations

import math

from steering_core.compiled import kernel

HOLES = 4
"""Number of drilled holes on each edge (source, chapter 5)."""


@kernel
def holes_area(diameter, uncovered):
    """Return the open area [m2] of an edge's round holes.

    uncovered: depth [m] of the circle segment that the spool uncovers, spool displacement plus
    underlap; the area is zero below zero and full above one diameter.
    """
    if uncovered <= 0.0:
        return 0.0
    radius = 0.5 * diameter
    if uncovered >= diameter:
        return HOLES * math.pi * radius * radius
    half_chord = math.sqrt(uncovered * (diameter - uncovered))
    angle = math.atan2(half_chord, radius - uncovered)
    return HOLES * (radius * radius * angle - (radius - uncovered) * half_chord)


@kernel
def holes_area_gradient(diameter, uncovered):
    """Return d(area)/d(uncovered) [m], the area gradient w: the chords' lengths."""
    if uncovered <= 0.0 or uncovered >= diameter:
        return 0.0
    return HOLES * 2.0 * math.sqrt(uncovered * (diameter - uncovered))
