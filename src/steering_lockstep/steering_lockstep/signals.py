"""The bench's signals by one name each: where every part of the bench finds them on the topics."""

from __future__ import annotations

PLACES: dict[str, tuple[str, str]] = {
    "steering_wheel_angle": ("/steering/torque", "steering_wheel_angle"),
    "steering_wheel_speed": ("/steering/torque", "steering_wheel_speed"),
    "torsion_bar_torque": ("/steering/torque", "torsion_bar_torque"),
    "left_pressure": ("/steering/pressure", "left"),
    "right_pressure": ("/steering/pressure", "right"),
    "supply_pressure": ("/steering/pressure", "supply"),
    "rack_position": ("/steering/rack", "position"),
    "rack_speed": ("/steering/rack", "speed"),
    "rack_force": ("/steering/rack", "force"),
    "driver_torque": ("/driver/torque", "torque"),
    "reference_angle": ("/driver/torque", "reference_angle"),
    "left_reference_pressure": ("/valve/left/command", "reference_pressure"),
    "left_solenoid_force": ("/valve/left/command", "solenoid_force"),
    "right_reference_pressure": ("/valve/right/command", "reference_pressure"),
    "right_solenoid_force": ("/valve/right/command", "solenoid_force"),
    "load_force": ("/vehicle/rack_force", "force"),
    "load_stiffness": ("/vehicle/rack_force", "stiffness"),
    "load_position": ("/vehicle/rack_force", "position"),
    "left_valve_opening": ("/valve/left/command", "solenoid_force"),
    "right_valve_opening": ("/valve/right/command", "solenoid_force"),
    "load_reference_force": ("/load_cylinder/command", "reference_force"),
    "load_valve_opening": ("/load_cylinder/command", "valve_opening"),
}
"""Name of a signal to its topic and field."""
