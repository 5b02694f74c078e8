"""Order of the integration, and what the step may change."""

import numpy as np
import pytest
from fine_steps import CLAMP

from steering_core.parameters import load_parameters
from steering_plant.plant import Plant

SYSTEMS = ("open_centre", "closed_centre", "servo_valve")
BAR = 1e5
NOT_DRIVEN = {("dry_park", "servo_valve")}
"""The rig's servo valves are for on-centre driving (section 7.2); parking they ring."""


def after_ten_ticks(loop, state, held, steps):
    """Return the state ten ticks on, under held inputs, with equal inner steps."""
    parameters = loop.parameters.with_values({"simulation.inner_steps": steps})
    plant = Plant(parameters, loop.valve_system)
    plant.state[:] = state
    for tick in range(10):
        plant.step(tick, *held)
    return plant.state


@pytest.mark.parametrize("system", SYSTEMS)
def test_the_error_falls_with_the_fifth_power_of_the_step(system, closed_loop, trajectory):
    """On a stretch without stick or reversal: the slope over a factor of four in the step."""
    loop = closed_loop("on_centre", system)
    states, inputs = trajectory("on_centre", system)
    at, span = 10_030, np.ptp(states, axis=0)
    exact = after_ten_ticks(loop, states[at], inputs[at], 64)
    steps = np.array([3, 4, 6, 8, 12])
    errors = [
        np.abs((after_ten_ticks(loop, states[at], inputs[at], n) - exact) / span).max()
        for n in steps
    ]
    slope, _ = np.polyfit(np.log(steps), np.log(errors), 1)
    assert 4.7 < -slope < 5.8


@pytest.mark.parametrize(
    ("name", "system"),
    [(n, s) for n in ("on_centre", "dry_park") for s in SYSTEMS if (n, s) not in NOT_DRIVEN],
)
def test_pressures_do_not_depend_on_the_step(name, system, closed_loop, trajectory):
    """Within 0.01 bar of the converged solution, in the closed loop over the whole manoeuvre."""
    converged = closed_loop(name, system, {"simulation.inner_steps": 20})
    expected, _ = converged.run(converged.plant())
    for tolerance in (0.1, 1.0, 3.0):
        loop = closed_loop(name, system, {"simulation.tolerance": tolerance})
        states = trajectory(name, system)[0] if tolerance == 1.0 else loop.run(loop.plant())[0]
        assert np.abs(states[:, 6:8] - expected[:, 6:8]).max() < 0.01 * BAR


def test_twenty_equal_steps_are_converged(closed_loop):
    """The last second, at 377 deg/s, against steps half as long."""
    pressures = []
    for steps in (20, 40):
        loop = closed_loop("on_centre", "closed_centre", {"simulation.inner_steps": steps})
        pressures.append(loop.run(loop.plant(), ticks=2000)[0][:, 6:8])
    assert np.abs(pressures[0] - pressures[1]).max() < 1e-4 * BAR


def test_steps_grow_shorter_where_the_valves_are_stiff():
    """A spool wide open with little pressure drop: 20 times the stiffness of on-centre driving."""
    plant = Plant(load_parameters(), "closed_centre")
    shortest = 1.0
    for tick in range(20):
        plant.step(tick, 0.0, 80.0, 0.0, 0.0, CLAMP, 0.0)
        shortest = min(shortest, float(plant.inner_step[0]))
    assert shortest < 1.7e-4
