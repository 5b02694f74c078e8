"""The load cell shows a force where there is none."""

from __future__ import annotations

from steering_plant.effects.base import Effect, Parameter, added_to

EFFECT = Effect(
    name="rack_force_sensor_offset",
    summary="the load cell shows a force where there is none",
    sees="pressure force and rack force disagree by a constant, at rest too",
    equation="F_measured = F + offset",
    source="E. O. Doebelin, Measurement Systems (2004), chapter 3: bias",
    balance="rack force sensor",
    excitation="rack motion in both directions",
    separating="the rack without load, moved slowly in both directions",
    parameters={"offset": Parameter("measured minus true force", "N", 0, -5000, 5000, 100)},
    sets={"offset": added_to("rack_force_sensor.offset")},
)
