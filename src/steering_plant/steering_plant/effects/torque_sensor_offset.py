"""The torque sensor shows a torque where there is none."""

from __future__ import annotations

from steering_plant.effects.base import Effect, Parameter, added_to

EFFECT = Effect(
    name="torque_sensor_offset",
    summary="the torque sensor shows a torque where there is none",
    sees="a measured torque at rest; closed centre: assistance to one side without hand torque",
    equation="T_measured = T + offset",
    source="E. O. Doebelin, Measurement Systems (2004), chapter 3: bias",
    balance="torque sensor",
    excitation="torsion-bar torque in both directions, or a wheel that is let go",
    separating="let go of the wheel with the rack in the middle and without load",
    parameters={"offset": Parameter("measured minus true torque", "N m", 0, -5, 5, 0.1)},
    sets={"offset": added_to("torque_sensor.offset")},
)
