"""Positions of the states in the plant's state vector, SI units, signs as in docs/signs_and_units.

Mechanics first, then the two chambers and the supplied energy; behind them the pump pressure of
the open-centre system, the two valves of the closed-centre one or the four servo valves; behind
these the load cylinder, if there is one, and last the effects' states.
"""

ANGLE, SPEED = 0, 1  # steering wheel [rad], [rad/s]
POSITION, VELOCITY = 2, 3  # rack [m], [m/s]
COLUMN_FRICTION, RACK_FRICTION = 4, 5  # friction elements [N m], [N]
LEFT, RIGHT = 6, 7  # chamber pressures [Pa]
ENERGY = 8  # hydraulic energy drawn from the supply [J]
PUMP = 9  # open centre: pressure of the pump line [Pa]
LEFT_VALVE, RIGHT_VALVE = 9, 12  # closed centre: first of three states of each valve
SPOOL, SPOOL_SPEED, CONTROL = 0, 1, 2  # within a valve: [m], [m/s], control chamber [Pa]
LEFT_SERVO, RIGHT_SERVO = 9, 13  # servo valves: first of four states of each chamber's pair
METER_IN, METER_IN_SPEED, METER_OUT, METER_OUT_SPEED = 0, 1, 2, 3  # spools [m], [m/s]

# Within the load cylinder's states, the first of which the record names (load_cylinder).
PISTON, PISTON_SPEED, PISTON_FRICTION = 0, 1, 2  # [m], [m/s], [N]
LOAD_LEFT, LOAD_RIGHT = 3, 4  # chamber pressures [Pa]
LOAD_SPOOL, LOAD_SPOOL_SPEED = 5, 6  # [m], [m/s]

OPEN_CENTRE_SIZE = 10
CLOSED_CENTRE_SIZE = 15
SERVO_VALVE_SIZE = 17

OPEN_CENTRE_NAMES = (
    "steering_wheel_angle",
    "steering_wheel_speed",
    "rack_position",
    "rack_speed",
    "column_friction",
    "rack_friction",
    "left_pressure",
    "right_pressure",
    "supply_energy",
    "pump_pressure",
)
CLOSED_CENTRE_NAMES = (
    *OPEN_CENTRE_NAMES[:9],
    "left_spool",
    "left_spool_speed",
    "left_control_pressure",
    "right_spool",
    "right_spool_speed",
    "right_control_pressure",
)
SERVO_VALVE_NAMES = (
    *OPEN_CENTRE_NAMES[:9],
    "left_meter_in_spool",
    "left_meter_in_spool_speed",
    "left_meter_out_spool",
    "left_meter_out_spool_speed",
    "right_meter_in_spool",
    "right_meter_in_spool_speed",
    "right_meter_out_spool",
    "right_meter_out_spool_speed",
)
LOAD_CYLINDER_NAMES = (
    "load_piston_position",
    "load_piston_speed",
    "load_piston_friction",
    "load_left_pressure",
    "load_right_pressure",
    "load_spool",
    "load_spool_speed",
)

# Positions in the vector of inputs held over a tick. With servo valves the two places of the
# solenoids' forces hold the commands of the chambers' valves, as a share of the spools' stroke.
# The load's force acts where there is no load cylinder, its valve's command where there is one.
DRIVER_TORQUE, LEFT_SOLENOID, RIGHT_SOLENOID = 0, 1, 2
LOAD_FORCE, LOAD_STIFFNESS, LOAD_POSITION, LOAD_VALVE = 3, 4, 5, 6
INPUTS = 7
INPUT_NAMES = (
    "driver_torque",
    "left_solenoid",
    "right_solenoid",
    "load_force",
    "load_stiffness",
    "load_position",
    "load_valve",
)

# Positions in the vector of flows that the right-hand side leaves behind [m3/s].
LEFT_FLOW, RIGHT_FLOW, SUPPLY_FLOW = 0, 1, 2
FLOWS = 3
FLOW_NAMES = ("left_flow_in", "right_flow_in", "supply_flow")
