"""An overlay as pressures: the share of one chamber.

An overlay torque T stands for a motor on the pinion: the load pressure p_right - p_left changes by
T R_T/A_p, whatever the boost curve's slope. One chamber is lowered by half of it, as far as its
pressure goes, and the other raised by the rest, so that no reference falls below zero.
"""

from __future__ import annotations

from typing import Any

from pressure_control.limits import bounded
from steering_core.compiled import kernel


@kernel
def overlaid(p: Any, reference: float, other: float, overlay: float) -> float:
    """Return this chamber's reference [Pa] with the overlay on it, not below zero.

    reference, other [Pa]: of this chamber and of the other one without overlay, not negative.
    overlay [N m]: at the steering wheel, positive pushes the rack as this chamber does.
    """
    change = overlay * p.gear_ratio / p.piston_area
    if change > 0.0:
        return reference + (change - min(0.5 * change, other))
    return reference - bounded(-0.5 * change, 0.0, reference)
