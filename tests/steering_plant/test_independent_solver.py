"""Every state over whole manoeuvres, against the independent plant under other solvers."""

import numpy as np
import pytest
from independent_plant import IndependentPlant

SYSTEMS = ("open_centre", "closed_centre")
MANOEUVRES = ("on_centre", "dry_park")
ALLOWED = 1e-3  # of a state's range over the manoeuvre


def assert_alike(states, expected, names, span):
    error = np.abs(states - expected).max(axis=0) / span
    worst = {name: value for name, value in zip(names, error, strict=True) if value > ALLOWED}
    assert not worst


@pytest.mark.parametrize("system", SYSTEMS)
@pytest.mark.parametrize("name", MANOEUVRES)
def test_every_state_in_the_closed_loop(name, system, closed_loop, trajectory):
    """Classical Runge-Kutta in 20 us; the two loops share nothing but the controllers."""
    loop = closed_loop(name, system)
    plant = IndependentPlant(loop.parameters, system, "runge_kutta")
    expected, _ = loop.run(plant)
    assert_alike(trajectory(name, system)[0], expected, plant.names, np.ptp(expected, axis=0))


@pytest.mark.parametrize("system", SYSTEMS)
@pytest.mark.parametrize("name", MANOEUVRES)
def test_every_state_against_lsoda(name, system, trajectory, closed_loop):
    """LSODA, restarted every tick under the recorded commands and never reset."""
    states, inputs = trajectory(name, system)
    plant = IndependentPlant(closed_loop(name, system).parameters, system, "LSODA")
    expected = replayed(plant, states, inputs)
    assert_alike(states, expected, plant.names, np.ptp(states, axis=0))


@pytest.mark.parametrize("system", SYSTEMS)
def test_every_state_against_radau(system, trajectory, closed_loop):
    """Radau over the fastest movement: 377 deg/s at the end of the sweep."""
    states, inputs = trajectory("on_centre", system)
    parameters = closed_loop("on_centre", system).parameters
    plant = IndependentPlant(parameters, system, "Radau", rtol=1e-6)
    expected = replayed(plant, states[-100:], inputs[-100:])
    assert_alike(states[-100:], expected, plant.names, np.ptp(states, axis=0))


def replayed(plant, states, inputs):
    """Return the states of ``plant`` from the first of ``states`` on under held ``inputs``."""
    plant.state = states[0].copy()
    expected = np.empty_like(states)
    for row, held in enumerate(inputs):
        expected[row] = plant.state
        plant.step(row, *held)
    return expected
