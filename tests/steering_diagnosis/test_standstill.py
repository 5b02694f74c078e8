"""Noise in the inputs must not shake friction loose in the replay while the gear stands still."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from steering_diagnosis.steering.standstill import BLEND, SHORTEST_S, calmed, restful, standstills

TICKS = 6000
TIME = np.arange(TICKS) * 1e-3


def steps(rate=0.0):
    """Return a position that goes to and fro and stands between, creeping at ``rate`` [1/s]."""
    raw = np.where(np.arange(TICKS) // 1000 % 2, 1.0, -1.0)
    window = np.hanning(201)
    moved = np.convolve(np.pad(raw, 100, mode="edge"), window / window.sum(), mode="valid")
    return moved + rate * TIME


def test_standstills_are_where_nothing_moves():
    found = standstills([steps(), steps() + 1e-3 * np.sin(0.2 * TIME)])
    assert len(found) == 6
    for part in found:
        assert np.ptp(steps()[part]) < 0.02
        assert (part.stop - part.start) * 1e-3 > 0.7


def test_what_one_of_two_moves_through_is_no_standstill():
    assert standstills([steps(), np.sin(2.0 * np.pi * 0.7 * TIME)]) == []
    assert standstills([]) == []


@given(st.floats(-2e-3, 2e-3), st.integers(0, 1000))
def test_noise_goes_and_creeping_stays(rate, seed):
    noise = 1e-4
    noisy = steps(rate) + noise * np.random.default_rng(seed).standard_normal(TICKS)
    where = standstills([steps(rate)])
    calm = calmed(noisy, where, 1.1 * noise)
    for part in where:
        inner = slice(part.start + int(0.5 * (part.stop - part.start)) + BLEND, part.stop - BLEND)
        assert np.std((calm - steps(rate))[inner]) < 0.4 * noise
    outside = np.ones(TICKS, bool)
    for part in where:
        outside[part] = False
    assert np.array_equal(calm[outside], noisy[outside])


@pytest.mark.parametrize("hz", [5.0, 20.0])
def test_what_shakes_more_than_noise_stays(hz):
    shaken = steps() + 5e-4 * np.sin(2.0 * np.pi * hz * TIME)
    where = [part for part in standstills([steps()]) if part.stop - part.start > SHORTEST_S * 1e3]
    assert np.array_equal(calmed(shaken, where, 1e-4), shaken)


@pytest.mark.parametrize(("trembling", "rests"), [(0.0, 6), (4.0, 0)])
def test_a_wheel_that_trembles_beyond_its_speeds_noise_does_not_rest(trembling, rests):
    noise = 4e-3
    speed = np.gradient(steps(), 1e-3) + noise * np.random.default_rng(5).standard_normal(TICKS)
    speed += trembling * noise * np.sin(2.0 * np.pi * 40.0 * TIME)
    assert len(restful(standstills([steps()]), speed, noise)) == rests
