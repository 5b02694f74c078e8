"""The rack is damped more than the data sheet says."""

from __future__ import annotations

from steering_plant.effects.base import Effect, Parameter, added_to

EFFECT = Effect(
    name="rack_viscous_damping",
    summary="the rack is damped more, in proportion to its speed",
    sees="torque that grows with the rack's speed; slower return after release",
    equation="F = (b_rw + added) v",
    source="H. E. Merritt, Hydraulic Control Systems (1967), chapter 6: power elements",
    balance="rack force",
    excitation="rack speeds above 20 mm/s",
    separating="triangles of angle at 3 and at 30 mm/s rack speed",
    parameters={"added": Parameter("to the data sheet's damping", "N s/m", 0, 0, 5e4, 3e3)},
    sets={"added": added_to("mechanics.rack_damping")},
)
