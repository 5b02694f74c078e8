"""One chamber's dead volume (line, hose) is larger than the other's."""

from __future__ import annotations

from steering_core.compiled import kernel
from steering_plant.effects.base import Effect, Parameter

LEAST = 0.1
"""Share of the nominal volume that is always left."""


@kernel
def left_volume(value, difference):
    """Return the left chamber's volume [m3]."""
    return max(value + 0.5 * difference, LEAST * value)


@kernel
def right_volume(value, difference):
    """Return the right chamber's volume [m3]."""
    return max(value - 0.5 * difference, LEAST * value)


EFFECT = Effect(
    name="chamber_volume_imbalance",
    summary="one chamber's dead volume is larger than the other's",
    sees="pressure of the larger chamber is slower and rings lower than the other's",
    equation="V_left + difference/2, V_right - difference/2",
    source="H. E. Merritt, Hydraulic Control Systems (1967), chapter 6: unequal volumes",
    balance="left chamber continuity",
    also=("right chamber continuity",),
    excitation="fast changes of pressure in both directions",
    separating="steps of pressure in either chamber against a blocked rack",
    competes=("open_centre.chamber_volume",),
    parameters={
        "difference": Parameter("left minus right volume", "m3", 0, -6e-5, 6e-5, 3e-5),
    },
    slots={"left_volume": left_volume, "right_volume": right_volume},
)
