"""The rack meets its end stop earlier, or a softer one."""

from __future__ import annotations

from steering_plant.effects.base import Effect, Parameter, factor_of, taken_from

EFFECT = Effect(
    name="rack_end_stop",
    summary="the rack meets its end stop earlier, or the stop is softer",
    sees="force and torque rise before the nominal end of the stroke, or less steeply",
    equation="F = factor k (|x| - (x_stop - earlier)) beyond the stop, with its damper",
    source="K. L. Johnson, Contact Mechanics (1985), chapter 11: spring and damper in contact",
    balance="rack force",
    excitation="the rack against both end stops",
    separating="a slow ramp of angle to both end stops",
    competes=("mechanics.rack_stop_position", "mechanics.rack_stop_stiffness"),
    parameters={
        "earlier": Parameter("contact before the nominal one", "m", 0, 0, 0.07, 0.01, shape=True),
        "stiffness": Parameter("over the data sheet's", "1", 1, 0.05, 10, 1, shape=True),
    },
    sets={
        "earlier": taken_from("mechanics.rack_stop_position"),
        "stiffness": factor_of("mechanics.rack_stop_stiffness"),
    },
)
