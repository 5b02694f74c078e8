"""The channels of a record: what is measured and commanded, with unit and sensor tolerance."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True)
class Channel:
    """One channel, SI, signs as in docs/signs_and_units.

    topic, field: where a bag has it. offset, gain: tolerance of its sensor, two standard deviations
    of one specimen, absolute [unit] and relative; a sensor within them is nominal.
    """

    unit: str
    topic: str
    field: str
    offset: float = 0.0
    gain: float = 0.0


TORQUE, PRESSURE, RACK = "/steering/torque", "/steering/pressure", "/steering/rack"
LEFT, RIGHT, LOAD = "/valve/left/command", "/valve/right/command", "/vehicle/rack_force"

MEASURED: dict[str, Channel] = {
    "steering_wheel_angle": Channel("rad", TORQUE, "steering_wheel_angle", 2e-3, 2e-3),
    "steering_wheel_speed": Channel("rad/s", TORQUE, "steering_wheel_speed", 0.0, 2e-3),
    "torsion_bar_torque": Channel("N m", TORQUE, "torsion_bar_torque", 0.02, 5e-3),
    "left_pressure": Channel("Pa", PRESSURE, "left", 2e4, 3e-3),
    "right_pressure": Channel("Pa", PRESSURE, "right", 2e4, 3e-3),
    "supply_pressure": Channel("Pa", PRESSURE, "supply", 2e4, 3e-3),
    "rack_position": Channel("m", RACK, "position", 2e-5, 2e-3),
    "rack_speed": Channel("m/s", RACK, "speed", 0.0, 2e-3),
    "rack_force": Channel("N", RACK, "force", 10.0, 5e-3),
}
"""What sensors measure; order of the plant's sensors."""

COMMANDED: dict[str, Channel] = {
    "driver_torque": Channel("N m", "/driver/torque", "torque"),
    "left_reference_pressure": Channel("Pa", LEFT, "reference_pressure"),
    "left_solenoid_force": Channel("N", LEFT, "solenoid_force"),
    "right_reference_pressure": Channel("Pa", RIGHT, "reference_pressure"),
    "right_solenoid_force": Channel("N", RIGHT, "solenoid_force"),
    "load_force": Channel("N", LOAD, "force"),
    "load_stiffness": Channel("N/m", LOAD, "stiffness"),
    "load_position": Channel("m", LOAD, "position"),
}
"""What was commanded; exact, where it was recorded at all."""

CHANNELS: dict[str, Channel] = MEASURED | COMMANDED
