"""What the bench exchanges with a rig: the plant's measurements and commands, by name and unit."""

MEASURED = {
    "steering_wheel_angle": "rad",
    "steering_wheel_speed": "rad/s",
    "torsion_bar_torque": "N m",
    "left_pressure": "Pa",
    "right_pressure": "Pa",
    "supply_pressure": "Pa",
    "rack_position": "m",
    "rack_speed": "m/s",
    "rack_force": "N",
}
"""Every rig measures these; order of /steering/torque, /steering/pressure, /steering/rack."""

COMMANDED = {
    "driver_torque": "N m",
    "left_reference_pressure": "Pa",
    "left_solenoid_force": "N",
    "right_reference_pressure": "Pa",
    "right_solenoid_force": "N",
    "load_force": "N",
    "load_stiffness": "N/m",
    "load_position": "m",
}
"""Fields of /driver/torque, /valve/left|right/command and /vehicle/rack_force that a rig may take.

A rig's table lists those that it takes: a rig with a hand on the wheel takes no driver torque, one
with its own pressure control takes reference pressures in place of solenoid forces.
"""

UNITS = MEASURED | COMMANDED

PERIOD_S = 1e-3
"""A tick; the rig sends one set of measurements in each."""
