"""The channels of a record: what is measured and commanded, with unit and sensor tolerance."""

from __future__ import annotations

from dataclasses import dataclass

from steering_lockstep.signals import PLACES


@dataclass(frozen=True)
class Channel:
    """One channel, SI, signs as in docs/signs_and_units.

    topic, field: where a bag has it. low, high: what no steering gear goes beyond, generously
    [unit]; what lies outside was not measured. offset, gain: tolerance of its sensor, two standard
    deviations of one specimen, absolute [unit] and relative; a sensor within them is nominal.
    """

    unit: str
    topic: str
    field: str
    low: float
    high: float
    offset: float = 0.0
    gain: float = 0.0


TORQUE, PRESSURE, RACK = "/steering/torque", "/steering/pressure", "/steering/rack"


LIMITS: dict[str, tuple[float, float]] = {
    "rad": (-50.0, 50.0),
    "rad/s": (-200.0, 200.0),
    "N m": (-1e3, 1e3),
    "Pa": (-1e6, 1e8),
    "m": (-2.0, 2.0),
    "m/s": (-20.0, 20.0),
    "N": (-1e6, 1e6),
    "N/m": (-1e10, 1e10),
}
"""What a quantity of any steering gear keeps within, several times over: 8 turns of the wheel, a
truck's rack, 1000 bar; below, a pressure sensor that is 9 bar off at no pressure."""


def _channel(name: str, unit: str, offset: float = 0.0, gain: float = 0.0) -> Channel:
    return Channel(unit, *PLACES[name], *LIMITS[unit], offset, gain)


MEASURED: dict[str, Channel] = {
    "steering_wheel_angle": _channel("steering_wheel_angle", "rad", 2e-3, 2e-3),
    "steering_wheel_speed": _channel("steering_wheel_speed", "rad/s", 0.0, 2e-3),
    "torsion_bar_torque": _channel("torsion_bar_torque", "N m", 0.02, 5e-3),
    "left_pressure": _channel("left_pressure", "Pa", 2e4, 3e-3),
    "right_pressure": _channel("right_pressure", "Pa", 2e4, 3e-3),
    "supply_pressure": _channel("supply_pressure", "Pa", 2e4, 3e-3),
    "rack_position": _channel("rack_position", "m", 2e-5, 2e-3),
    "rack_speed": _channel("rack_speed", "m/s", 0.0, 2e-3),
    "rack_force": _channel("rack_force", "N", 10.0, 5e-3),
}
"""What sensors measure; order of the plant's sensors."""

COMMANDED: dict[str, Channel] = {
    "driver_torque": _channel("driver_torque", "N m"),
    "left_reference_pressure": _channel("left_reference_pressure", "Pa"),
    "left_solenoid_force": _channel("left_solenoid_force", "N"),
    "right_reference_pressure": _channel("right_reference_pressure", "Pa"),
    "right_solenoid_force": _channel("right_solenoid_force", "N"),
    "load_force": _channel("load_force", "N"),
    "load_stiffness": _channel("load_stiffness", "N/m"),
    "load_position": _channel("load_position", "m"),
}
"""What was commanded; exact, where it was recorded at all."""

CHANNELS: dict[str, Channel] = MEASURED | COMMANDED
