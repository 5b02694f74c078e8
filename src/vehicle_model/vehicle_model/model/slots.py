"""Slots of the vehicle, where effects act. Here, without effects, each is the identity.

As in the plant (steering_plant.model.slots): the nominal value first, then what it may depend on,
then the state ``y``, which ends with the effects' states, and the effects' parameters ``e``.
"""

from __future__ import annotations

from steering_core.compiled import kernel


@kernel
def next_states(force, distance, y, e):
    """Move the effects' states, the last ones of ``y``, on to this tick.

    force: the tyres' steady rack force [N] at this tick. distance: rolled in one tick [m].
    """


@kernel
def rack_force(value, distance, y, e):
    """Rack force of the tyres [N]."""
    return value


@kernel
def stiffness(value, distance, y, e):
    """Stiffness of the tyres at the rack within the coming tick [N/m]."""
    return value
