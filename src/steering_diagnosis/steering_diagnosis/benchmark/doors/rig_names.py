"""What a rig calls its channels, their units in its files, and the mapping that says so."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from typing import Any, NamedTuple

import numpy as np

from steering_diagnosis.data.channels import CHANNELS
from steering_diagnosis.data.units import factor


class Written(NamedTuple):
    """A channel in a rig's file: name, unit, sign, and the device that measures it."""

    name: str
    unit: str
    sign: int = 1
    device: str = "steering"


RIG_NAMES: Mapping[str, Written] = {
    "steering_wheel_angle": Written("SteerAngle", "deg", -1),
    "steering_wheel_speed": Written("SteerSpeed", "deg/s", -1),
    "torsion_bar_torque": Written("TBTorque", "Nm"),
    "driver_torque": Written("MotorTorque", "Nm"),
    "left_pressure": Written("pL", "bar", device="hydraulics"),
    "right_pressure": Written("pR", "bar", device="hydraulics"),
    "supply_pressure": Written("pS", "bar", device="hydraulics"),
    "left_reference_pressure": Written("pLRef", "bar", device="hydraulics"),
    "left_solenoid_force": Written("FLSol", "N", device="hydraulics"),
    "right_reference_pressure": Written("pRRef", "bar", device="hydraulics"),
    "right_solenoid_force": Written("FRSol", "N", device="hydraulics"),
    "rack_position": Written("xRack", "mm", device="rack"),
    "rack_speed": Written("vRack", "mm/s", device="rack"),
    "rack_force": Written("FRack", "kN", device="rack"),
    "load_force": Written("FLoad", "kN", device="rack"),
    "load_stiffness": Written("kLoad", "N/mm", device="rack"),
    "load_position": Written("xLoad", "mm", device="rack"),
}


def in_rig_units(channel: str, values: np.ndarray) -> np.ndarray:
    """Return SI values as a rig's file has them."""
    written = RIG_NAMES[channel]
    return written.sign * values / factor(written.unit, CHANNELS[channel].unit, channel)


def mapping(system: str, channels: Iterable[str], prefix: str = "", **more: Any) -> dict[str, Any]:
    """Return the content of a mapping file. prefix: of the names in the file."""
    found: dict[str, Any] = {}
    for channel in channels:
        written = RIG_NAMES[channel]
        found[channel] = {"from": f"{prefix}{written.name}", "unit": written.unit}
        if written.sign < 0:
            found[channel]["sign"] = written.sign
    return {"schema": 1, "valve_system": system, **more, "channels": found}
