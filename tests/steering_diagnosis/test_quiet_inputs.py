"""Inputs of the replay: fast motion from the speed unless the two disagree, and no vacuum."""

import numpy as np
import pytest
from scipy.interpolate import CubicHermiteSpline

from steering_core.parameters import load_parameters
from steering_diagnosis.data.record import Record
from steering_diagnosis.steering.drive import RUN_UP, Drive
from steering_diagnosis.steering.smoothing import low_pass
from steering_plant.model import states

TIME = np.arange(12_000) * 1e-3
PHASE = 2.0 * np.pi * (0.3 + 0.14 * TIME) * TIME
ANGLE = 0.6 * np.sin(PHASE)
SPEED = 0.6 * np.cos(PHASE) * 2.0 * np.pi * (0.3 + 0.28 * TIME)
ANGLE_NOISE, SPEED_NOISE = 1.5e-4, 4e-3


def errors(speed):
    """Return the wheel's curve with noise on both sensors, less the angle, and whether it fused."""
    random = np.random.default_rng(7)
    channels = {
        "steering_wheel_angle": ANGLE + ANGLE_NOISE * random.standard_normal(len(TIME)),
        "rack_force": np.zeros(len(TIME)),
        "left_pressure": np.full(len(TIME), 1e6),
        "right_pressure": np.full(len(TIME), 1e6),
    }
    if speed is not None:
        noise = SPEED_NOISE * random.standard_normal(len(TIME))
        channels["steering_wheel_speed"] = speed + noise
    curve = Drive(Record("open_centre", channels, load_parameters())).curves["steering_wheel_angle"]
    return curve.values[RUN_UP:] - ANGLE, not curve.low_passed


def acceleration(error):
    return np.std(np.diff(error, 2)[500:-500]) / 1e-6


def test_fast_motion_comes_from_the_quieter_speed():
    together, fused = errors(SPEED)
    alone, nothing = errors(None)
    assert fused
    assert not nothing
    assert np.std(together[500:-500]) < 0.7 * np.std(alone[500:-500])
    assert acceleration(together) < 0.3 * acceleration(alone)


def test_a_driver_who_moves_with_the_noise_he_feels_does_not_part_the_two():
    random = np.random.default_rng(7)
    noise = ANGLE_NOISE * random.standard_normal(len(TIME))
    # What he answers is a part of the noise between 3 and 10 Hz, where nothing else moves.
    answer = 0.6 * (low_pass(noise, 10.0) - low_pass(noise, 3.0))
    angle = 0.02 * np.sin(2.0 * np.pi * 0.05 * TIME) + answer
    channels = {
        "steering_wheel_angle": angle + noise,
        "steering_wheel_speed": np.gradient(angle, 1e-3) + 3e-4 * random.standard_normal(12_000),
        "rack_force": np.zeros(len(TIME)),
        "left_pressure": np.full(len(TIME), 1e6),
        "right_pressure": np.full(len(TIME), 1e6),
    }
    curve = Drive(Record("open_centre", channels, load_parameters())).curves["steering_wheel_angle"]
    assert not curve.low_passed


DISAGREEING = {"gain": 1.02 * SPEED, "delay": np.roll(SPEED, 8), "dead": 0.0 * SPEED}


@pytest.mark.parametrize("what", DISAGREEING)
def test_where_the_two_disagree_the_position_stays(what):
    error, fused = errors(DISAGREEING[what])
    assert not fused
    assert np.std(error[500:-500]) < 2.0 * ANGLE_NOISE


@pytest.mark.parametrize("frequency_hz", [0.2, 20.0])
def test_a_chamber_that_is_sucked_empty_is_followed_no_further_than_a_vacuum(frequency_hz):
    nominal = load_parameters()
    pressure = 1e6 * np.cos(2.0 * np.pi * frequency_hz * TIME)
    channels = {
        "steering_wheel_angle": ANGLE,
        "rack_force": np.zeros(len(TIME)),
        "left_pressure": pressure,
        "right_pressure": np.full(len(TIME), 1e6),
    }
    driven = Drive(Record("closed_centre", channels, nominal)).driven(nominal)
    (left,) = np.flatnonzero(driven.at == states.LEFT)
    given, slope = driven.given[RUN_UP:, left], driven.slopes[RUN_UP:, left]
    empty = pressure < -nominal["oil.atmospheric_pressure"]
    assert given.min() > -nominal["oil.atmospheric_pressure"]
    assert np.ptp(given[empty]) == 0.0
    assert np.abs(slope[empty]).max() == 0.0
    between = CubicHermiteSpline(TIME, given, slope)(np.linspace(1.0, 2.0, 9000))
    assert between.min() > -nominal["oil.atmospheric_pressure"]
    assert np.allclose(given[pressure > 0.0], pressure[pressure > 0.0], atol=1e3)
