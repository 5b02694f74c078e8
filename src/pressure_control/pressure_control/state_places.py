"""Positions of the states of the pressure control valve's controller."""

INTEGRAL, FILTERED, SLIP, TORQUE, SPOOL_SEEN = range(5)
"""Integrator [Pa], low-passed control error [Pa], low-passed speed difference [m/s], low-passed
torque [N m]; and the spool's displacement [m], put there by who has a sensor for it."""

ANSWER = 5
"""The answer's integral [Pa]; behind it, by tick, what the loop would have answered [Pa]."""

LONGEST = 8
"""Ticks that are kept; a delay of up to one less can be compensated."""

STATES = ANSWER + 1 + LONGEST
