"""A logger's clock and stamps: what they do is no motion of the gear."""

import numpy as np
import pytest

from steering_diagnosis.data.resample import Sampled, on_grid
from steering_diagnosis.data.ticks import in_ticks

N = 6000
TICKS = np.arange(N) * 1e-3


def wave(t):
    return 1.5 * np.sin(2.0 * np.pi * 1.1 * t)


def channel(name, time, values):
    return Sampled(name, time, values, period=float(np.median(np.diff(time))))


def record(time, at, seed=0):
    """A wheel's angle and a command that jumps at ticks. at: when the samples were taken."""
    random = np.random.default_rng(seed)
    angle = wave(at) + 1e-4 * random.standard_normal(len(at))
    command = np.floor(np.round(at / 1e-3) / 40.0) % 5.0
    return {
        "steering_wheel_angle": channel("steering_wheel_angle", time, angle),
        "left_reference_pressure": channel("left_reference_pressure", time, command),
    }


@pytest.mark.parametrize("drift", [-1.5e-4, 5e-5, 1e-4])
@pytest.mark.parametrize("jitter", [0.0, 6e-5])
def test_a_clock_of_its_own_and_stamps_that_jitter_leave_each_sample_as_it_was(drift, jitter):
    random = np.random.default_rng(1)
    stamps = 812.5 + (1.0 + drift) * (TICKS + jitter * random.standard_normal(N))
    kept = random.uniform(size=N) > 2e-3
    kept[[0, 1]] = True
    there = record(stamps[kept], TICKS[kept])
    notes: list[str] = []
    found = in_ticks(there, notes)
    for name, c in found.items():
        grid = on_grid(c, float(c.time[0]), N - 2)
        inside = np.flatnonzero(kept[: N - 2])
        np.testing.assert_array_equal(grid[inside], there[name].values[: len(inside)])
    assert any("ppm" in note for note in notes)


def test_samples_that_were_taken_when_their_stamps_say_stay_there():
    random = np.random.default_rng(2)
    stamps = TICKS + 8e-5 * random.standard_normal(N)
    found = in_ticks(record(stamps, stamps), [])["steering_wheel_angle"]
    grid = on_grid(found, float(found.time[0]), N - 2)
    error = grid - wave(found.time[0] + np.arange(N - 2) * 1e-3)
    assert np.nanstd(error) < 1.3e-4
    # Taken for even, they would be off by the wheel's speed times 0.08 ms.
    assert np.std(wave(stamps) - wave(TICKS)) > 4e-4


def test_two_devices_on_one_clock_stay_together():
    """The rack's device samples slower by 80 ppm; scaled for itself it would end 0.5 ms late."""
    slow = 0.2 + TICKS * (1.0 + 8e-5)
    channels = {
        "steering_wheel_angle": channel("steering_wheel_angle", TICKS, wave(TICKS)),
        "rack_position": channel("rack_position", slow, wave(slow)),
    }
    found = in_ticks(channels, [])
    start = float(found["rack_position"].time[0])
    both = [on_grid(c, start, 5700) for c in found.values()]
    inner = np.isfinite(both[0]) & np.isfinite(both[1])
    assert inner.sum() > 5000
    assert np.max(np.abs(both[0] - both[1])[inner]) < 1e-4


@pytest.mark.parametrize("period", [2e-3, 5e-4, 1.0005e-3])
def test_other_rates_are_interpolated_as_before(period):
    time = np.arange(4000) * period
    channels = {"steering_wheel_angle": channel("steering_wheel_angle", time, wave(time))}
    notes: list[str] = []
    assert in_ticks(channels, notes) is channels
    assert not notes
