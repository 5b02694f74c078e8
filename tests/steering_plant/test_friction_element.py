"""The friction element by itself: hysteresis, limit, and the energy it can give back."""

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from steering_core.parameters import load_parameters
from steering_plant.model.friction import friction_rate, limited
from steering_plant.model.mechanics import rack_band
from steering_plant.model.states import LEFT, RACK_FRICTION, RIGHT, VELOCITY
from steering_plant.plant import Plant, plant_record

DISPLACEMENT = 1e-4  # m
EFFECTS = np.zeros(0)


def moved(force, limit, distance, parts=400):
    """Return force and work after a slow movement, midpoint rule."""
    step = distance / parts
    work = 0.0
    for _ in range(parts):
        half = force + 0.5 * step * friction_rate(force, limit, math.copysign(1.0, step), 1.0) * (
            math.copysign(1.0, step) / DISPLACEMENT
        )
        half = limited(half, limit)
        rate = friction_rate(half, limit, math.copysign(1.0, step), DISPLACEMENT)
        force = limited(force + abs(step) * rate, limit)
        work += half * step
    return force, work


def recoverable(force, limit):
    """Work that unloading to zero force gives back: the integral of F x_0/(F_lim + F) dF."""
    share = abs(force) / limit
    return DISPLACEMENT * limit * (share - math.log1p(share))


def test_loading_is_exponential_in_the_displacement():
    for share in (0.5, 1.0, 3.0):
        force, _ = moved(0.0, 100.0, share * DISPLACEMENT, parts=4000)
        assert force == pytest.approx(100.0 * (1.0 - math.exp(-share)), rel=1e-5)


def test_unloading_gives_back_what_can_be_recovered():
    distance = DISPLACEMENT * math.log((100.0 + 80.0) / 100.0)
    force, work = moved(80.0, 100.0, -distance, parts=4000)
    assert abs(force) < 1e-3
    assert -work == pytest.approx(recoverable(80.0, 100.0), rel=1e-4)


def test_a_slow_cycle_is_a_closed_loop_that_costs_four_limits_a_millimetre():
    """Far beyond the displacement constant the loop's area is 4 F_lim times the amplitude."""
    force, _ = moved(0.0, 100.0, 2e-3)
    force, there = moved(force, 100.0, -4e-3, parts=8000)
    assert force == pytest.approx(-100.0)
    force, back = moved(force, 100.0, 4e-3, parts=8000)
    assert force == pytest.approx(100.0)
    # After each reversal the force still helps along: 2 F_lim exp(-s/x_0) beside the rectangle.
    lost = 2.0 * DISPLACEMENT * 100.0 * 2.0
    assert there + back == pytest.approx(4.0 * 100.0 * 2e-3 - lost, rel=1e-3)


@given(st.lists(st.tuples(st.floats(-3e-4, 3e-4), st.floats(0.0, 50.0)), min_size=1, max_size=12))
@settings(max_examples=60, deadline=None)
def test_it_never_creates_energy(path):
    """Passive while the limit holds or rises: no path takes out more than was stored."""
    force, limit, work = 0.0, 60.0, 0.0
    for distance, rise in path:
        limit += rise
        force, done = moved(force, limit, distance)
        work += done
        assert recoverable(force, limit) <= work + 1e-7


@given(st.floats(-500.0, 500.0), st.floats(0.0, 500.0))
def test_a_limit_only_releases(force, limit):
    held = limited(force, limit)
    assert abs(held) <= min(abs(force), limit)
    assert held * force >= 0.0


@given(st.floats(-60.0, 60.0), st.floats(-1.0, 1.0))
def test_the_rate_is_odd_and_stops_at_the_limit(force, velocity):
    assert friction_rate(-force, 60.0, -velocity, 1e-4) == -friction_rate(
        force, 60.0, velocity, 1e-4
    )
    assert friction_rate(60.0, 60.0, abs(velocity), 1e-4) == 0.0
    assert friction_rate(-60.0, 60.0, -abs(velocity), 1e-4) == 0.0


FIGURES = [(5, 82.0), (10, 104.0), (20, 148.0), (40, 236.0), (60, 324.0), (80, 412.0)]


@pytest.mark.parametrize(("bar", "newton"), FIGURES)
def test_the_racks_limit_grows_with_both_pressures(bar, newton):
    par = plant_record(load_parameters(), "open_centre")
    state = np.zeros(10)
    state[[LEFT, RIGHT]] = bar * 1e5
    assert rack_band(par[0], state, EFFECTS)[1:] == pytest.approx((-newton, newton), abs=0.5)
    state[LEFT], state[RIGHT] = -9e4, 2.0 * bar * 1e5
    assert rack_band(par[0], state, EFFECTS)[1:] == pytest.approx((-newton, newton), abs=0.5)


def test_falling_pressure_releases_the_rack(closed_loop, trajectory):
    """Over a whole manoeuvre the force stays within the limit of the present pressures."""
    states, _ = trajectory("dry_park", "closed_centre")
    limit = 60.0 + 2.2e-5 * (states[:, LEFT] + states[:, RIGHT])
    assert np.all(np.abs(states[:, RACK_FRICTION]) <= limit)
    assert np.abs(states[:, RACK_FRICTION]).max() > 200.0


@pytest.mark.parametrize("system", ["open_centre", "closed_centre"])
def test_over_every_cycle_friction_takes_energy(system, closed_loop, trajectory):
    states, _ = trajectory("on_centre", system)
    power = states[:, RACK_FRICTION] * states[:, VELOCITY] * 1e-3
    work = np.cumsum(power)
    assert work[-1] > 1.0
    # What a spring of 490 N and 0.1 mm can give back, and no more.
    assert np.min(work - np.maximum.accumulate(work)) > -0.31 * 490.0 * 1e-4


def test_it_holds_the_rack_against_a_small_force():
    """60 N are held by 0.1 mm; what leaks away is the damper's creep, not the friction's."""
    plant = Plant(load_parameters(), "open_centre")
    for tick in range(500):
        plant.step(tick, 0.0, 0.0, 0.0, 30.0, 0.0, 0.0)
    assert abs(plant.state[2]) < 1e-4
