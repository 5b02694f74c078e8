"""Gain, offset, noise, resolution, delay and lag of the measured channels."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from steering_core.parameters import ParameterError, load_parameters
from steering_plant.plant import Plant
from steering_plant.sensors import (
    CHANNELS,
    HISTORY_ROWS,
    LONGEST_DELAY,
    measure,
    normal,
    sensor_table,
)

PARAMETERS = load_parameters()


def measured(changes, true, ticks=None):
    """Return what the sensors report of ``true``, rows by tick."""
    sensors = sensor_table(PARAMETERS.with_values(changes))
    history, out = np.zeros((HISTORY_ROWS, len(CHANNELS))), np.zeros(len(CHANNELS))
    rows = []
    for tick in range(ticks or len(true)):
        measure(sensors, PARAMETERS["simulation.noise_seed"], history, tick, true[tick], out)
        rows.append(out.copy())
    return np.array(rows)


@pytest.fixture
def signal():
    return np.random.default_rng(1).normal(size=(200, len(CHANNELS)))


def test_ideal_sensors_report_the_truth(signal):
    assert np.array_equal(measured({}, signal), signal)


def test_gain_and_offset(signal):
    changes = {"angle_sensor.gain": -1.5, "angle_sensor.offset": 0.25, "torque_sensor.gain": 2.0}
    reported = measured(changes, signal)
    assert np.array_equal(reported[:, 0], -1.5 * signal[:, 0] + 0.25)
    assert np.array_equal(reported[:, 1], -1.5 * signal[:, 1])  # a rate has no offset
    assert np.array_equal(reported[:, 2], 2.0 * signal[:, 2])
    assert np.array_equal(reported[:, 3:], signal[:, 3:])


@given(st.floats(1e-4, 2.0), st.floats(-50.0, 50.0))
def test_resolution_rounds_to_the_nearest_step(resolution, value):
    true = np.full((1, len(CHANNELS)), value)
    reported = measured({"torque_sensor.resolution": resolution}, true)[0, 2]
    assert abs(reported - value) <= 0.5 * resolution * (1.0 + 1e-9) + 1e-12
    assert reported / resolution == pytest.approx(round(reported / resolution), abs=1e-6)


@pytest.mark.parametrize("ticks", [0, 1, 7, LONGEST_DELAY - 1])
def test_a_delay_shifts_and_holds_the_first_value(ticks, signal):
    reported = measured({"left_pressure_sensor.delay": ticks * 1e-3}, signal)
    past = np.maximum(np.arange(len(signal)) - ticks, 0)
    assert np.array_equal(reported[:, 3], signal[past, 3])
    assert np.array_equal(reported[:, 4], signal[:, 4])


@given(st.floats(0.0, LONGEST_DELAY * 1e-3 - 1e-3))
def test_a_delay_within_a_tick_is_linear_between_samples(delay):
    ramp = np.tile(np.arange(100.0)[:, None], (1, len(CHANNELS)))
    reported = measured({"left_pressure_sensor.delay": delay}, ramp)[:, 3]
    assert reported == pytest.approx(np.maximum(ramp[:, 3] - 1e3 * delay, 0.0), abs=1e-5)


@pytest.mark.parametrize("lag", [2e-4, 1e-3, 7.3e-3])
def test_a_lag_answers_a_ramp_and_a_sine_as_a_first_order_filter(lag):
    """Closed forms of tau y' = x - y; the sine of 5 Hz is nearly linear within a tick."""
    t = np.arange(400) * 1e-3
    omega = 2.0 * np.pi * 5.0
    true = np.zeros((len(t), len(CHANNELS)))
    true[:, 3], true[:, 4] = t, np.sin(omega * t)
    changes = {"left_pressure_sensor.lag": lag, "right_pressure_sensor.lag": lag}
    reported = measured(changes, true)
    ramp = t - lag * (1.0 - np.exp(-t / lag))
    phase = np.arctan(omega * lag)
    sine = np.cos(phase) * (np.sin(omega * t - phase) + np.sin(phase) * np.exp(-t / lag))
    assert reported[:, 3] == pytest.approx(ramp, abs=1e-12)
    assert reported[:, 4] == pytest.approx(sine, abs=2e-4)


def test_a_delay_beyond_the_history_is_refused():
    changed = PARAMETERS.with_values({"rack_force_sensor.delay": LONGEST_DELAY * 1e-3})
    with pytest.raises(ParameterError, match=r"rack_force_sensor\.delay must be at most 63 ms"):
        sensor_table(changed)


def test_noise_is_white_normal_and_of_the_stated_size():
    draws = np.array([[normal(1.0, c, tick) for tick in range(20_000)] for c in (0, 2, 3)])
    assert np.abs(draws.mean(axis=1)).max() < 4.0 / np.sqrt(20_000)
    assert draws.std(axis=1) == pytest.approx(np.ones(3), abs=0.02)
    share = np.mean(np.abs(draws) < 1.0, axis=1)
    assert share == pytest.approx(np.full(3, 0.6827), abs=0.015)
    assert np.abs(np.corrcoef(draws) - np.eye(3)).max() < 0.03
    assert np.abs([np.corrcoef(row[1:], row[:-1])[0, 1] for row in draws]).max() < 0.03


def test_noise_repeats_and_follows_its_seed():
    assert normal(1.0, 3, 17) == normal(1.0, 3, 17)
    assert len({normal(seed, 3, 17) for seed in (1.0, 2.0, 3.0)}) == 3


def test_noise_reaches_the_measurement_and_not_the_plant():
    noisy = PARAMETERS.with_values({"torque_sensor.noise": 0.1})
    plants = [Plant(p, "open_centre") for p in (PARAMETERS, noisy, noisy)]
    held = (1.0, 0.0, 0.0, 0.0, 1e6, 0.0)
    rows = [[plant.step(tick, *held)[2] for plant in plants] for tick in range(200)]
    assert np.array_equal(plants[0].state, plants[1].state)
    clean, first, second = np.array(rows).T
    assert np.array_equal(first, second)
    assert np.std(first - clean) == pytest.approx(0.1, rel=0.2)
