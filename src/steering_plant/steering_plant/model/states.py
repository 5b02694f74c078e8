"""Positions of the states in the plant's state vector, SI units, signs as in docs/signs_and_units.

Mechanics first, then the two chambers and the supplied energy; behind them the pump pressure of
the open-centre system or the two valves of the closed-centre one; behind these the effects' states.
"""

ANGLE, SPEED = 0, 1  # steering wheel [rad], [rad/s]
POSITION, VELOCITY = 2, 3  # rack [m], [m/s]
COLUMN_FRICTION, RACK_FRICTION = 4, 5  # friction elements [N m], [N]
LEFT, RIGHT = 6, 7  # chamber pressures [Pa]
ENERGY = 8  # hydraulic energy drawn from the supply [J]
PUMP = 9  # open centre: pressure of the pump line [Pa]
LEFT_VALVE, RIGHT_VALVE = 9, 12  # closed centre: first of three states of each valve
SPOOL, SPOOL_SPEED, CONTROL = 0, 1, 2  # within a valve: [m], [m/s], control chamber [Pa]

OPEN_CENTRE_SIZE = 10
CLOSED_CENTRE_SIZE = 15

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

# Positions in the vector of inputs held over a tick.
DRIVER_TORQUE, LEFT_SOLENOID, RIGHT_SOLENOID = 0, 1, 2
LOAD_FORCE, LOAD_STIFFNESS, LOAD_POSITION = 3, 4, 5
INPUTS = 6
INPUT_NAMES = (
    "driver_torque",
    "left_solenoid",
    "right_solenoid",
    "load_force",
    "load_stiffness",
    "load_position",
)

# Positions in the vector of flows that the right-hand side leaves behind [m3/s].
LEFT_FLOW, RIGHT_FLOW, SUPPLY_FLOW = 0, 1, 2
FLOWS = 3
