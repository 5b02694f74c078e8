"""Times and frequencies of the source's tests of a part."""

import math

import numpy as np
import pytest
from fine_steps import CLAMP, sampled

from steering_core.parameters import load_parameters
from steering_plant.plant import Plant
from steering_plant.rest import rest_solenoid_force

BAR = 1e5


def test_free_oscillation_of_the_steering_wheel():
    """Fig 3.9: 5.15 Hz with the rack clamped; the decay is the damper's."""
    parameters = load_parameters().with_values({"mechanics.column_friction": 0.0})
    plant = Plant(parameters, "open_centre")
    plant.state[0] = math.radians(1.0)
    angle = np.empty(4000)
    for tick in range(len(angle)):
        angle[tick] = plant.step(tick, 0.0, 0.0, 0.0, 0.0, CLAMP, 0.0)[0]
    up = np.flatnonzero((angle[:-1] < 0.0) & (angle[1:] >= 0.0))
    crossings = up + angle[up] / (angle[up] - angle[up + 1])
    assert 1000.0 / np.mean(np.diff(crossings)) == pytest.approx(5.15, rel=0.005)
    size = np.abs(angle).reshape(-1, 400).max(axis=1)
    decay = np.polyfit(0.4 * np.arange(len(size)), np.log(size), 1)[0]
    assert -decay == pytest.approx(0.06 / (2.0 * 0.058), rel=0.1)


def test_stiffness_of_the_clamped_wheel():
    """Fig 3.8: 1.06 N m/deg."""
    plant = Plant(load_parameters(), "open_centre")
    for tick in range(6000):
        plant.step(tick, min(tick * 1e-3, 2.0), 0.0, 0.0, 0.0, CLAMP, 0.0)
    assert plant.out[2] / math.degrees(plant.out[0]) == pytest.approx(1.06, rel=0.002)


@pytest.fixture(scope="module")
def step_response():
    """Return time [s] and chamber pressure [bar] of a step of 100 bar with a locked rack."""
    plant = Plant(load_parameters(), "closed_centre")
    low, high = 5.0 * BAR, 105.0 * BAR
    forces = [rest_solenoid_force(plant.par[0], pressure) for pressure in (low, high)]
    sampled(plant, (0.0, forces[0], forces[0], 0.0, CLAMP, 0.0), 1e-3, 300)
    states = sampled(plant, (0.0, forces[1], forces[1], 0.0, CLAMP, 0.0), 2e-5, 5000)
    return 2e-5 * np.arange(len(states)), states[:, 6] / BAR


def test_step_of_100_bar(step_response):
    """Fig 6.7: 90 % in 5 ms, less than 5 bar too much."""
    time, pressure = step_response
    rise = pressure - pressure[0]
    assert time[np.argmax(rise > 90.0)] == pytest.approx(5e-3, rel=0.1)
    assert rise.max() < 105.0


def test_the_valve_holds_what_it_is_told(step_response):
    """Locked rack, no load flow: the pressure of the solenoid's force, within 0.5 bar."""
    _, pressure = step_response
    assert pressure[0] == pytest.approx(5.0, abs=0.5)
    assert pressure[-1] == pytest.approx(105.0, abs=0.5)
