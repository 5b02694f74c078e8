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

PLACES = {
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
"""Topic and field of each signal. A signal of a new topic is a line here and one above."""

UNITS = MEASURED | COMMANDED

PERIOD_S = 1e-3
"""A tick; the rig sends one set of measurements in each."""
