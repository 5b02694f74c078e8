"""What the bench exchanges with a rig: the plant's measurements and commands, by name and unit.

Their topics and fields are steering_lockstep.signals; a signal of a new topic is a line there too.
"""

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
    "left_valve_opening": "1",
    "right_valve_opening": "1",
    "load_reference_force": "N",
    "load_valve_opening": "1",
}
"""What a rig may take; its channel table lists those that it does take.

A rig with a hand on the wheel takes no driver torque, one with its own pressure control takes
reference pressures in place of solenoid forces, one with servo valves takes openings, a share of
the spools' stroke. With a load cylinder the load is its valve's opening; the references go along
so that command and measurement can be watched.
"""

UNITS = MEASURED | COMMANDED

PERIOD_S = 1e-3
"""A tick; the rig sends one set of measurements in each."""
