"""Play between pinion and rack."""

from __future__ import annotations

from steering_core.compiled import kernel
from steering_plant.effects.base import Effect, Parameter


@kernel
def torsion_torque(value, twist, gap):
    """Return the torsion bar's torque [N m]: none inside the gap, its stiffness at the flanks."""
    if gap <= 0.0:
        return value
    half = 0.5 * gap
    if abs(twist) <= half:
        return 0.0
    return value * (1.0 - half / abs(twist))


EFFECT = Effect(
    name="rack_backlash",
    summary="play between pinion and rack",
    sees="a flat piece of torque through zero; the wheel turns a little without resistance",
    equation="T = K_T (twist - clip(twist, -gap/2, gap/2))",
    source="M. Nordin and P.-O. Gutman, Automatica 38 (2002), 1633-1649, section 2: dead zone",
    balance="torsion bar",
    excitation="torque reversals through zero, slowly",
    separating="triangles of angle of a few degrees about centre, and about 20 degrees",
    parameters={
        "gap": Parameter("whole play, angle at the pinion", "rad", 0, 0, 0.1, 0.01, shape=True)
    },
    slots={"torsion_torque": torsion_torque},
)
