"""Positions in the truth's state vector and inputs, SI."""

ANGLE, SPEED, RACK, RACK_SPEED = 0, 1, 2, 3
LEFT, RIGHT, SUPPLY = 4, 5, 6
LEFT_VALVE, RIGHT_VALVE = 7, 10  # spool, its speed, control chamber
LEFT_MAGNET, RIGHT_MAGNET = 13, 15  # two lags each
BENDING, BENDING_SPEED = 17, 18  # mass on an elastic rack
LEFT_HOSE, RIGHT_HOSE = 19, 20  # volume taken up by viscoelastic hoses [m3]
ENERGY = 21
SMOOTH = 22
"""So many states are integrated; those behind are frictions, solved apart."""
COLUMN_FRICTION, RACK_FRICTION, LOAD_FRICTION = 22, 23, 24
LEFT_STICTION, RIGHT_STICTION, BAR_HYSTERESIS = 25, 26, 27
STATES = 28

TORQUE_IN, LEFT_IN, RIGHT_IN, FORCE_IN, STIFFNESS_IN, POSITION_IN, TIME, ACCELERATION, RISE = range(
    9
)
LEFT_RISE, RIGHT_RISE = 9, 10
INPUTS = 11

(
    ANGLE_OUT,
    SPEED_OUT,
    TORQUE_OUT,
    LEFT_OUT,
    RIGHT_OUT,
    SUPPLY_OUT,
    RACK_OUT,
    RACK_SPEED_OUT,
    FORCE_OUT,
) = range(9)
CHANNELS = 9
"""Order of data.channels.MEASURED."""
