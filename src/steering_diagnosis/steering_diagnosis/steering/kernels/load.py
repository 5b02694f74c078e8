"""What stands behind the rack's load: a friction element, and the vehicle, along a given motion."""

from __future__ import annotations

import math

from steering_core.compiled import kernel
from vehicle_model.model.step import vehicle_step


@kernel
def friction_along(position, level, displacement, force):
    """Fill ``force`` (n,) [N] of a friction element along a motion ``position`` (n,) [m].

    The exponential spring of docs/equations, solved exactly over each tick's way.
    """
    force[0] = 0.0
    for k in range(1, position.shape[0]):
        way = position[k] - position[k - 1]
        end = math.copysign(level, way)
        force[k] = end + (force[k - 1] - end) * math.exp(-abs(way) / displacement)


@kernel
def tyre_force(par, external, e, state, out, position, force):
    """Fill ``force`` (n,) [N]: what the vehicle puts on the rack at its ``position`` (n,) [m]."""
    for tick in range(position.shape[0]):
        vehicle_step(par, external, e, state, out, tick, position[tick], 0.0, 0.0)
        force[tick] = out[0] + out[1] * (position[tick] - out[2])
