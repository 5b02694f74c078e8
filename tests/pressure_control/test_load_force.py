"""The load cylinder's force control: what it asks for, its limits, and the gain it allows."""

from collections import deque

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from pressure_control.load_force import LoadForceController, load_force_rate
from pressure_control.load_loop import largest_load_gain, load_spectral_radius
from steering_core.parameters import load_parameters
from steering_plant.model import states
from steering_plant.plant import Plant

PARAMETERS = load_parameters()
STIFF = 1e10
LOOSE = {
    "load_cylinder.friction": 1e-6,
    "mechanics.rack_friction": 1e-6,
    "mechanics.rack_friction_pressure_slope": 1e-15,
}


def clamped(parameters):
    """A plant whose rack is as heavy as a clamp is stiff: it does not move within a test."""
    heavy = {"mechanics.rack_mass": 1e6, "mechanics.rack_damping": 1e9}
    return Plant(parameters.with_values(LOOSE | heavy), "servo_valve", load_cylinder=True)


def grows(gain, delay, ticks=1200):
    parameters = PARAMETERS.with_values({"load_force_controller.gain": gain})
    plant, control = clamped(parameters), LoadForceController(parameters)
    way = deque([0.0] * (delay + 1), maxlen=delay + 1)
    forces = np.empty(ticks)
    for tick in range(ticks):
        way.append(float(control.step(tick, *plant.out[6:], 1.0, 0.0, 0.0)[1]))  # type: ignore[call-arg]
        plant.step(tick, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, way[0])
        forces[tick] = plant.out[8]
    return np.ptp(forces[-100:]) > 1.0


@pytest.mark.parametrize("delay", [0, 1])
def test_the_limit_of_the_sampled_loop_is_the_simulations(delay):
    """A clamped piston; underlap doubles the flow gain in the middle, so it is made small."""
    limit = largest_load_gain(PARAMETERS, STIFF, delay)
    assert not grows(0.45 * limit, delay)
    assert grows(1.1 * limit, delay)


def test_the_chosen_gain_stands_a_tick_of_delay_whatever_holds_the_rack():
    for stiffness in (1e5, 1e6, 1e7, STIFF):
        for delay in (0, 1):
            assert load_spectral_radius(PARAMETERS, stiffness, delay) < 1.0


def test_a_clamped_piston_takes_a_step_of_force():
    """As the linear loop has it: no overshoot beyond 20 %, 2 % left of the error after 40 ms."""
    plant, control = clamped(PARAMETERS), LoadForceController(PARAMETERS)
    forces = []
    for tick in range(80):
        opening = control.step(tick, *plant.out[6:], 1000.0, 0.0, 0.0)[1]  # type: ignore[call-arg]
        plant.step(tick, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, opening)
        forces.append(plant.out[8])
    assert max(forces) < 1200.0
    assert forces[40] == pytest.approx(1000.0, abs=20.0)


def test_the_rate_of_the_force_is_the_plants():
    plant = clamped(PARAMETERS)
    first = int(plant.par[0]["load_cylinder"]) + states.LOAD_SPOOL
    for tick in range(12):
        plant.step(tick, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.01)
    before, at = plant.out[8], plant.state[first] / PARAMETERS["servo_valve.stroke"]
    plant.step(12, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.01)
    expected = load_force_rate(PARAMETERS) * at * 1e-3
    assert plant.out[8] - before == pytest.approx(expected, rel=0.1)


def test_the_wanted_load_is_force_and_stiffness():
    control = LoadForceController(PARAMETERS)
    wanted = control.step(0, 2e-3, 0.0, 0.0, 100.0, 1e6, 1e-3)[0]
    assert wanted == pytest.approx(1100.0)


@given(st.lists(st.floats(-1e9, 1e9), min_size=6, max_size=6))
@settings(max_examples=200, deadline=None)
def test_mirrored_and_within_limits(values):
    one, other = LoadForceController(PARAMETERS), LoadForceController(PARAMETERS)
    x, v, made, force, stiffness, at = values
    a = one.step(0, x, v, made, force, abs(stiffness), at).copy()
    b = other.step(0, -x, -v, -made, -force, abs(stiffness), -at)
    assert np.array_equal(a, -b)
    assert -1.0 <= a[1] <= 1.0
