"""The steering wheel angle is measured late."""

from __future__ import annotations

from steering_plant.effects.base import Effect, Parameter, added_to

EFFECT = Effect(
    name="angle_sensor_delay",
    summary="the steering wheel angle is measured late",
    sees="phase between this channel and the others in proportion to frequency",
    equation="theta_measured(t) = theta(t - delay)",
    source="E. O. Doebelin, Measurement Systems (2004), chapter 3: dead time",
    balance="angle sensor",
    excitation="steering above 1 Hz",
    separating="a sine sweep of angle from 0.5 to 10 Hz",
    parameters={
        "delay": Parameter("age of the measured value", "s", 0, 0, 0.05, 0.004, shape=True)
    },
    sets={"delay": added_to("angle_sensor.delay")},
)
