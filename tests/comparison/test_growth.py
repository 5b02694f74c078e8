"""Growth with frequency is seen where it is, and not where it is not."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays

from steering_bringup.comparison.growth import bands, growth, half_cycles

TIME = np.arange(10_000) * 1e-3
PHASE, FREQUENCY = 0.2 * np.pi * TIME**2, 0.2 * TIME
ANGLE = np.sin(PHASE)


def test_half_cycles_of_a_sine_have_its_frequency():
    bounds = half_cycles(TIME, np.sin(2 * np.pi * 1.3 * TIME))
    assert np.allclose(0.5 / np.diff(bounds), 1.3, rtol=1e-4)
    assert len(bounds) - 1 == pytest.approx(2 * 1.3 * 10, abs=1)


def test_noise_around_zero_makes_no_half_cycles():
    noise = 0.03 * np.random.default_rng(1).normal(size=len(TIME))
    quiet, noisy = half_cycles(TIME, ANGLE), half_cycles(TIME, ANGLE + noise)
    assert len(noisy) == len(quiet)
    assert np.allclose(noisy[3:], quiet[3:], atol=0.05)


def test_half_cycles_lie_at_the_zeros_of_the_sweep():
    zeros = np.sqrt(np.arange(20) / 0.2)
    assert np.allclose(half_cycles(TIME, ANGLE), zeros[zeros < 9.95], atol=1e-3)


@pytest.mark.parametrize("power", [1.0, 2.0])
def test_a_difference_that_comes_with_frequency(power):
    found = growth(TIME, ANGLE, 0.05 * FREQUENCY**power * np.cos(PHASE))
    assert found is not None
    assert found.with_frequency_only
    assert found.rank > 0.95
    assert found.static_share < 0.1


@pytest.mark.parametrize(
    "error",
    [
        0.1 * np.sin(PHASE),
        0.05 + 0.05 * FREQUENCY * np.cos(PHASE),
        0.1 * (2.0 - FREQUENCY) * np.cos(PHASE),
        0.1 * np.random.default_rng(2).normal(size=len(TIME)),
    ],
    ids=["static", "offset beside it", "falling", "noise"],
)
def test_a_difference_from_elsewhere(error):
    found = growth(TIME, ANGLE, error)
    assert found is not None
    assert not found.with_frequency_only


def test_what_cannot_be_judged():
    assert growth(TIME, np.sin(2 * np.pi * TIME), np.cos(TIME)) is None
    assert growth(TIME[:2000], ANGLE[:2000], ANGLE[:2000]) is None
    assert growth(TIME, np.zeros(len(TIME)), ANGLE) is None


def test_no_difference_at_all_does_not_grow():
    found = growth(TIME, ANGLE, np.zeros(len(TIME)))
    assert found is not None
    assert not found.with_frequency_only


@given(arrays(float, st.integers(2, 300), elements=st.floats(-10, 10)))
def test_bands_add_up_to_the_whole(error):
    total = sum(rms**2 for _, _, rms in bands(error, 1e-3))
    assert total == pytest.approx(float(np.mean(error**2)), rel=1e-9, abs=1e-12)


def test_a_sine_is_in_its_band():
    rows = {(a, b): rms for a, b, rms in bands(0.3 * np.sin(2 * np.pi * 3.0 * TIME), 1e-3)}
    assert rows[2.0, 5.0] == pytest.approx(0.3 / np.sqrt(2))
    assert rows[5.0, 10.0] == pytest.approx(0.0, abs=1e-9)
