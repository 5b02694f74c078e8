"""Violent commands, stops and limits."""

import numpy as np
import pytest
from fine_steps import CLAMP

from steering_core.parameters import load_parameters
from steering_plant.plant import Plant

PARAMETERS = load_parameters()
VACUUM = -1e5
PRESSURES = {"open_centre": [6, 7, 9], "closed_centre": [6, 7, 11, 14]}


@pytest.mark.parametrize("seed", range(6))
@pytest.mark.parametrize("system", PRESSURES)
def test_no_pressure_falls_below_absolute_zero(system, seed):
    """Torque, solenoids and load jump from stop to stop; volumes starve and fill again."""
    draw, plant = np.random.default_rng(seed), Plant(PARAMETERS, system)
    lowest = np.inf
    for tick in range(1500):
        if tick % 20 == 0:
            torque, load = 100.0 * draw.integers(-1, 2), 15e3 * draw.integers(-1, 2)
            left, right = draw.choice([0.0, 40.0, 80.0], size=2)
        plant.step(tick, torque, left, right, load, 0.0, 0.0)
        lowest = min(lowest, plant.state[PRESSURES[system]].min())
    assert VACUUM < lowest < -0.9e5
    assert np.all(np.isfinite(plant.state))


def test_a_starved_chamber_comes_back_without_losing_oil():
    """Pulled apart and put back under the same load, the pressures find their old values."""
    plant = Plant(PARAMETERS, "open_centre")
    before = plant.state[6:8].copy()
    starved = 0.0
    for tick in range(2500):
        load = -12e3 if 100 <= tick < 140 else 0.0
        plant.step(tick, 0.0, 0.0, 0.0, load, 2e5, 0.0)
        starved = min(starved, plant.state[6], plant.state[7])
    assert starved < -0.9e5
    assert plant.state[6:8] == pytest.approx(before, rel=0.02)


@pytest.mark.parametrize("sign", [-1.0, 1.0])
def test_end_stops_hold(sign):
    """Against 60 N m and the full boost the rack goes 1 mm into the stop at most."""
    damped = PARAMETERS.with_values({"mechanics.steering_wheel_damping": 2.0})
    plant = Plant(damped, "open_centre")
    furthest = 0.0
    for tick in range(4000):
        plant.step(tick, sign * 60.0, 0.0, 0.0, 0.0, 0.0, 0.0)
        furthest = max(furthest, sign * plant.state[2])
    assert 0.075 < furthest < 0.0765
    push = 60.0 * 130.9 + 7e-4 * sign * (plant.state[7] - plant.state[6])
    friction = sign * plant.state[5]
    column = 0.3 * 130.9
    depth = (push - friction - column) / 2e7
    assert sign * plant.state[2] - 0.075 == pytest.approx(depth, rel=0.02)
    assert abs(plant.state[3]) < 1e-6


def test_the_relief_valve_limits_the_pump():
    """All flow goes over the relief valve when the bridge is shut: 120 bar and 11.7 bar more."""
    plant = Plant(PARAMETERS, "open_centre")
    highest = 0.0
    for tick in range(1000):
        plant.step(tick, 30.0, 0.0, 0.0, 0.0, CLAMP, 0.0)
        highest = max(highest, plant.state[9])
    assert 120e5 < plant.state[9] < 120e5 + 1.1667e-4 / 1e-10
    assert highest < 140e5


@pytest.mark.parametrize("force", [0.0, 200.0])
def test_the_spools_stops_hold(force):
    plant = Plant(PARAMETERS, "closed_centre")
    deepest = 0.0
    for tick in range(300):
        plant.step(tick, 0.0, force, force, 0.0, CLAMP, 0.0)
        deepest = max(deepest, np.abs(plant.state[[9, 12]]).max())
    assert deepest < 1.3e-3
    if force > 0.0:
        assert plant.state[6] == pytest.approx(200e5, rel=1e-3)


@pytest.mark.parametrize("steps", [0, 5])
def test_a_run_repeats_to_the_bit(steps):
    ends = []
    for _ in range(2):
        plant = Plant(PARAMETERS.with_values({"simulation.inner_steps": steps}), "closed_centre")
        for tick in range(300):
            plant.step(tick, 3.0 * np.sin(0.05 * tick), 25.0, 20.0, 0.0, 4e5, 0.0)
        ends.append(plant.state.copy())
    assert np.array_equal(ends[0], ends[1])
