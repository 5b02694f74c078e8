"""The load cell's gain is wrong."""

from __future__ import annotations

from steering_plant.effects.base import Effect, Parameter, factor_of

EFFECT = Effect(
    name="rack_force_sensor_gain",
    summary="the rack force is measured too large or too small",
    sees="pressure force and rack force disagree by a factor",
    equation="F_measured = gain F",
    source="E. O. Doebelin, Measurement Systems (2004), chapter 3: sensitivity error",
    balance="rack force sensor",
    excitation="rack forces above 1 kN",
    separating="hold known loads against the rack in both directions",
    competes=("mechanics.piston_area",),
    parameters={"gain": Parameter("measured over true force", "1", 1, 0.5, 1.5, 1.08)},
    sets={"gain": factor_of("rack_force_sensor.gain")},
)
