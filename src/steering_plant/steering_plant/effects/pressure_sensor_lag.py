"""Both pressure sensors follow the pressure late (long or thin lines to them)."""

from __future__ import annotations

from steering_plant.effects.base import Effect, Parameter, added_to

EFFECT = Effect(
    name="pressure_sensor_lag",
    summary="both pressure sensors follow the pressure with a first-order lag",
    sees="measured pressures late and rounded at fast changes, alike on both sides",
    equation="tau p_measured' = p - p_measured",
    source="E. O. Doebelin, Measurement Systems (2004), chapter 3: first-order instruments",
    balance="pressure sensors",
    excitation="pressure changes faster than 1 Hz",
    separating="steps of pressure against a blocked rack",
    parameters={"time_constant": Parameter("of the lag", "s", 0, 0, 0.05, 0.005)},
    sets={"time_constant": added_to("left_pressure_sensor.lag", "right_pressure_sensor.lag")},
)
