"""The noise of a channel that was sampled more seldom than the grid has instants."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from steering_diagnosis.data.resample import on_grid, sampled
from steering_diagnosis.steering.smoothing import Curve, noise_like, spectrum

SECONDS = 20.0
NOISE = 0.3


def interpolated(rate, slow_hz=1.0, seed=0):
    """Return a slow motion with white noise of ``NOISE``, sampled at ``rate``, on the grid."""
    time = np.arange(0.0, SECONDS, 1.0 / rate)
    motion = 10.0 * np.sin(2.0 * np.pi * slow_hz * time)
    noise = NOISE * np.random.default_rng(seed).standard_normal(len(time))
    return on_grid(sampled("channel", time, motion + noise), 0.0, int(1000 * (SECONDS - 0.1)))


@settings(max_examples=15, deadline=None)
@given(rate=st.floats(60.0, 960.0), seed=st.integers(0, 99))
def test_the_noise_in_the_frequencies_of_motion_is_found(rate, seed):
    found = spectrum(interpolated(rate, seed=seed), rate_hz=rate)
    # as much in each Hz as white noise of a channel on ticks with this standard deviation
    assert found.noise == pytest.approx(NOISE * np.sqrt(1000.0 / rate), rel=0.2)
    assert found.cutoff_hz <= 30.0


def test_a_slow_noisy_channel_is_smoothed():
    values = interpolated(100.0)
    assert Curve(values, 1e-2, 0, rate_hz=100.0).smoothed
    assert spectrum(values).noise < 0.1 * NOISE  # as if it had come at every tick


def test_another_draw_of_its_noise_has_as_much_of_it():
    values = interpolated(100.0)
    drawn = noise_like(values, np.random.default_rng(1), 100.0)
    own, other = spectrum(values, rate_hz=100.0), spectrum(drawn, rate_hz=100.0)
    assert other.noise == pytest.approx(own.noise, rel=0.2)
