"""Reference pressure of a chamber: what the open-centre valve would hold there.

Everything here is written for the right chamber. The left one is the right one of the mirrored
gear: torque, speeds and load flow with the opposite sign and, where the boost curve was measured,
the mirrored table. So the two sides cannot differ by so much as a rounding error.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from pressure_control.limits import bounded
from pressure_control.overlay.split import overlaid
from steering_core.compiled import kernel
from steering_plant.boost_curve import static_pressures

TORQUE_LIMIT = 50.0
"""Largest torsion-bar torque [N m] that is looked up; far beyond any boost curve's end."""

SPEED_LIMIT = 10.0
"""Largest rack speed [m/s] that is believed; far beyond any steering gear."""


@kernel
def reference_pressures(
    p: Any, table: np.ndarray, torque: float, load_flow: float, supply: float, overlay: float = 0.0
) -> tuple[float, float]:
    """Return (right chamber's reference, open-centre valve's load pressure) [Pa].

    torque: torsion-bar torque [N m]. load_flow [m3/s]: into the right chamber; counted up to
    reference_flow_limit of the pump flow, as the static map has no meaning beyond the pump flow.
    supply: measured supply pressure [Pa]. common_pressure_raise is added to the reference, which
    stays between zero and the supply less reference_supply_margin. overlay [N m]: torque at the
    steering wheel as from a motor on the pinion, on top of what the open-centre valve would do.
    """
    limit = p.reference_flow_limit * p.pump_flow
    right, left = static_pressures(
        p, table, bounded(torque, -TORQUE_LIMIT, TORQUE_LIMIT), bounded(load_flow, -limit, limit)
    )
    highest = max(supply - p.reference_supply_margin, 0.0)
    raised = p.common_pressure_raise
    wanted = overlaid(p, right + raised, left + raised, overlay)
    return bounded(wanted, 0.0, highest), right - left


@kernel
def compensation_speed(
    p: Any, slip: float, wheel_speed: float, rack_speed: float
) -> tuple[float, float]:
    """Return (rack speed of the flow compensation, new filter state) [m/s].

    The steering wheel's speed leads, and what the rack does otherwise comes in through a low-pass
    (velocity_lowpass). The wheel's speed alone leaves the torsion bar's winding out of the flow;
    the rack's own closes a fast loop from pressure over rack speed to the reference.
    wheel_speed: steering wheel speed/gear_ratio. slip: filter state, the low-passed difference.
    """
    slip += p.slip_weight * (rack_speed - wheel_speed - slip)
    return wheel_speed + slip, slip


def mirrored(table: np.ndarray) -> np.ndarray:
    """Return the boost table (see measured_boost_curve) of the mirrored gear, -f(-torque)."""
    if len(table) == 0:
        return table
    starts, cubics = table[:, 0], table[:, 1:]
    pieces = [
        _mirrored_piece(cubic, end - start)
        for cubic, start, end in zip(cubics[:-1], starts[:-1], starts[1:], strict=True)
    ]
    # The last piece has no end: its mirror image begins one below the mirrored knot, as in
    # boost_table, and is a straight line like it.
    pieces.append(_mirrored_piece(cubics[-1], 1.0))
    begins = np.append(-starts[1:], -starts[-1] - 1.0)
    return np.column_stack([begins, np.array(pieces)])[np.argsort(begins)]


def _mirrored_piece(cubic: np.ndarray, length: float) -> np.ndarray:
    image = -np.poly1d(cubic)(np.poly1d([-1.0, length]))
    return np.concatenate([np.zeros(4 - len(image.coeffs)), image.coeffs])
