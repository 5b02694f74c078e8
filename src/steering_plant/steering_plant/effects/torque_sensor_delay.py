"""The torsion-bar torque is measured late."""

from __future__ import annotations

from steering_plant.effects.base import Effect, Parameter, added_to

EFFECT = Effect(
    name="torque_sensor_delay",
    summary="the torsion-bar torque is measured late",
    sees="phase between this channel and the others in proportion to frequency",
    equation="T_measured(t) = T(t - delay)",
    source="E. O. Doebelin, Measurement Systems (2004), chapter 3: dead time",
    balance="torque sensor",
    excitation="steering above 1 Hz",
    separating="a sine sweep of angle from 0.5 to 10 Hz",
    parameters={
        "delay": Parameter("age of the measured value", "s", 0, 0, 0.05, 0.004, shape=True)
    },
    sets={"delay": added_to("torque_sensor.delay")},
)
