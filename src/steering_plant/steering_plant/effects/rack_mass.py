"""The moving mass at the rack differs from the data sheet."""

from __future__ import annotations

from steering_plant.effects.base import Effect, Parameter, added_to

EFFECT = Effect(
    name="rack_mass",
    summary="the moving mass at the rack is larger or smaller",
    sees="force in proportion to the rack's acceleration; lower resonance",
    equation="(M_rw + added) x'' = sum of forces",
    source="equation 4.2 of the source; 20 kg of it are weights on the rig (section 3.1)",
    balance="rack force",
    excitation="rack acceleration above 1 m/s2: steering above 3 Hz",
    separating="a sine sweep of angle from 1 to 10 Hz",
    parameters={"added": Parameter("to the data sheet's mass", "kg", 0, -20, 200, 12)},
    sets={"added": added_to("mechanics.rack_mass")},
)
