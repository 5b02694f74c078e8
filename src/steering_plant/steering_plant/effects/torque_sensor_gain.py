"""The torque sensor's gain is wrong."""

from __future__ import annotations

from steering_plant.effects.base import Effect, Parameter, factor_of

EFFECT = Effect(
    name="torque_sensor_gain",
    summary="the torsion-bar torque is measured too large or too small",
    sees="more or less assistance at the same hand torque; torque and twist disagree by a factor",
    equation="T_measured = gain T",
    source="sensor data sheets state a gain error of 1 to 3 %",
    balance="torque sensor",
    excitation="torsion-bar torque above 1 N m",
    separating="turn the wheel against a blocked rack; compare torque with twist and with pressure",
    parameters={"gain": Parameter("measured over true torque", "1", 1, 0.5, 1.5, 1.05)},
    sets={"gain": factor_of("torque_sensor.gain")},
)
