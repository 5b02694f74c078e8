"""Breaking the rack loose takes more force than keeping it moving."""

from __future__ import annotations

import math

from steering_core.compiled import kernel
from steering_plant.effects.base import Effect, Parameter


@kernel
def rack_friction_limit(value, velocity, breakaway, speed):
    """Return the limit of the rack's friction [N]."""
    if breakaway <= 0.0:
        return value
    ratio = velocity / speed
    return value + breakaway * math.exp(-ratio * ratio)


EFFECT = Effect(
    name="rack_stribeck_friction",
    summary="breaking the rack loose takes more force than keeping it moving",
    sees="a bump of torque at every reversal; slow motion sticks and slips",
    equation="F_lim = F_C + breakaway exp(-(v/speed)^2)",
    source="B. Armstrong-Helouvry, P. Dupont, C. Canudas de Wit, Automatica 30 (1994), 1083-1138",
    balance="rack force",
    excitation="reversals, and rack speeds from a tenth to five times the Stribeck speed",
    separating="triangles of angle at 1, 3, 10 and 30 mm/s rack speed",
    competes=("mechanics.rack_friction",),
    parameters={
        "breakaway": Parameter("force above sliding friction", "N", 0, 0, 1000, 100),
        "speed": Parameter("at which 37 % of it are left", "m/s", 0.003, 1e-3, 0.1, 0.003, True),
    },
    slots={"rack_friction_limit": rack_friction_limit},
)
