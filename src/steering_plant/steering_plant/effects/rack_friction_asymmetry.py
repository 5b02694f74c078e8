"""The rack moves harder to one side than to the other."""

from __future__ import annotations

from steering_core.compiled import kernel
from steering_plant.effects.base import Effect, Parameter

MOST = 0.9
"""Share of the friction by which a direction may differ from the mean of both."""


@kernel
def rack_friction_middle(value, limit, coulomb):
    """Return the middle of the friction's two limits [N]."""
    return value + min(max(0.5 * coulomb, -MOST * limit), MOST * limit)


@kernel
def rack_force(value, velocity, viscous):
    """Return the resisting force [N]: extra damping in one direction alone."""
    return value + abs(viscous) * velocity if viscous * velocity > 0.0 else value


EFFECT = Effect(
    name="rack_friction_asymmetry",
    summary="the rack moves harder to one side than to the other",
    sees="torque to the left and to the right differ by a constant, or in proportion to speed",
    equation="F = half (F_left + F_right) sign(v) + coulomb/2; |viscous| v where v has its sign",
    source="A. Janot, M. Gautier, M. Brunot, Data set and reference models of EMPS (2019)",
    balance="rack force",
    excitation="rack motion in both directions, for the viscous part above 20 mm/s",
    separating="triangles of angle at 1 and at 30 mm/s, both directions, without load",
    parameters={
        "coulomb": Parameter("friction to the left minus to the right", "N", 0, -200, 200, 60),
        "viscous": Parameter("damping to the left minus right", "N s/m", 0, -2e4, 2e4, 3e3),
    },
    slots={"rack_friction_middle": rack_friction_middle, "rack_force": rack_force},
)
