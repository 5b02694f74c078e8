"""Left and right are equal to the last bit."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from steering_core.parameters import load_parameters
from steering_plant.boost_curve import FORMULA, boost_record, opening_areas, static_pressures
from steering_plant.model import states
from steering_plant.model.states import LEFT, LEFT_VALVE, RIGHT, RIGHT_VALVE
from steering_plant.plant import Plant
from steering_plant.rest import rest_solenoid_force

PARAMETERS = load_parameters()
CURVE = boost_record(PARAMETERS)[0]


def mirrored(state):
    other = state.copy()
    other[:6] = -other[:6]
    other[[LEFT, RIGHT]] = state[[RIGHT, LEFT]]
    if len(state) == 15:
        other[LEFT_VALVE : LEFT_VALVE + 3] = state[RIGHT_VALVE : RIGHT_VALVE + 3]
        other[RIGHT_VALVE : RIGHT_VALVE + 3] = state[LEFT_VALVE : LEFT_VALVE + 3]
    if len(state) >= 17:
        left, right = states.LEFT_SERVO, states.RIGHT_SERVO
        other[left : left + 4] = state[right : right + 4]
        other[right : right + 4] = state[left : left + 4]
    if len(state) > 17:
        other[17:] = -state[17:]
        pressures = 17 + states.LOAD_LEFT, 17 + states.LOAD_RIGHT
        other[list(pressures)] = state[list(pressures[::-1])]
    return other


@pytest.mark.parametrize("system", ["open_centre", "closed_centre"])
def test_mirrored_commands_give_the_mirrored_motion(system):
    plant, mirror = Plant(PARAMETERS, system), Plant(PARAMETERS, system)
    draw = np.random.default_rng(7)
    idle = rest_solenoid_force(plant.par[0], plant.state[LEFT]) if len(plant.state) == 15 else 0.0
    for tick in range(2000):
        if tick % 25 == 0:
            torque, load, place = draw.normal(size=3) * (5.0, 1500.0, 1e-3)
            left, right = idle + 6.0 * draw.normal(size=2)
        plant.step(tick, torque, left, right, load, 4e5, place)
        mirror.step(tick, -torque, right, left, -load, 4e5, -place)
        assert np.array_equal(mirrored(plant.state), mirror.state)


@pytest.mark.parametrize("load_cylinder", [False, True])
def test_mirrored_servo_valves_give_the_mirrored_motion(load_cylinder):
    plant, mirror = (
        Plant(PARAMETERS, "servo_valve", load_cylinder=load_cylinder) for _ in range(2)
    )
    draw = np.random.default_rng(7)
    for tick in range(2000):
        if tick % 25 == 0:
            torque, load, place = draw.normal(size=3) * (5.0, 1500.0, 1e-3)
            left, right, valve = draw.normal(size=3) * (0.2, 0.2, 0.1)
        plant.step(tick, torque, left, right, load, 4e5, place, valve)
        mirror.step(tick, -torque, right, left, -load, 4e5, -place, -valve)
        assert np.array_equal(mirrored(plant.state), mirror.state)


def test_the_closed_loop_is_mirrored_too(closed_loop):
    """Turning to the other side first: the on-centre manoeuvre upside down."""
    ways = []
    for sign in (1.0, -1.0):
        loop = closed_loop("on_centre", "closed_centre", {"angle_sensor.gain": 1.0})
        loop.scenario = loop.scenario.model_copy(
            update={"manoeuvre": _Turned(loop.scenario.manoeuvre, sign)}
        )
        ways.append(loop.run(loop.plant(), ticks=3000)[0])
    assert np.array_equal(np.array([mirrored(state) for state in ways[0]]), ways[1])


class _Turned:
    """A manoeuvre's choice whose angle has the other sign."""

    def __init__(self, choice, sign):
        self.choice, self.sign = choice, sign

    def make(self):
        manoeuvre, sign = self.choice.make(), self.sign

        class Turned(type(manoeuvre)):  # type: ignore[misc]
            def angle(self, t):
                return sign * manoeuvre.angle(t)

        return Turned()


@given(st.floats(-20.0, 20.0), st.floats(-0.9, 0.9))
@settings(max_examples=200, deadline=None)
def test_the_static_map_is_mirrored(torque, share):
    flow = share * CURVE["pump_flow"]
    assert opening_areas(CURVE, FORMULA, torque) == opening_areas(CURVE, FORMULA, -torque)[::-1]
    right, left = static_pressures(CURVE, FORMULA, torque, flow)
    assert static_pressures(CURVE, FORMULA, -torque, -flow) == (left, right)
