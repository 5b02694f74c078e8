"""The servo valves' controller: lead-lag of (7.15), symmetry, limits, and when it is stable."""

from collections import deque

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.signal import TransferFunction, dlsim, freqresp

from pressure_control.controller import CONTROLLERS
from pressure_control.errors import ControllerError
from pressure_control.servo_controller import ServoValveController, lead_lag
from pressure_control.servo_loop import (
    check_servo_stability,
    largest_servo_gain,
    servo_loop_matrix,
    servo_points,
    servo_spectral_radius,
)
from pressure_control.servo_point import servo_point
from pressure_control.servo_record import servo_controller_record
from steering_core.parameters import load_parameters
from steering_core.ticks import TICK_PERIOD
from steering_plant.plant import Plant

PARAMETERS = load_parameters()
LOOSE = {
    "mechanics.rack_friction": 1e-6,
    "mechanics.rack_friction_pressure_slope": 1e-15,
    "mechanics.column_friction": 1e-9,
}
"""Without friction, as the linear models are."""
FINITE = st.floats(-1e6, 1e6)


def changed(**values):
    return PARAMETERS.with_values({f"servo_valve.{n}": v for n, v in values.items()})


def frequency_response(parameters, frequencies):
    """The sampled lead-lag's response, from its pulse response."""
    controller = ServoValveController(parameters, "right")
    pulse = [1.0] + [0.0] * 40_000
    response = []
    for error in pulse:
        led, controller.state[0] = lead_lag(controller.par[0], controller.state, error)
        response.append(led)
    turn = np.exp(-2j * np.pi * np.outer(frequencies, np.arange(len(pulse))) * TICK_PERIOD)
    return turn @ np.array(response)


@pytest.mark.parametrize("ratio", [0.01, 0.1])
def test_the_sampled_lead_lag_is_that_of_7_15(ratio):
    """Within 12 % up to 100 Hz, which is a tenth of the sampling."""
    parameters = changed(lag_ratio=ratio)
    p = parameters.group("servo_valve")
    point = servo_point(parameters, 0.0, 0.0)
    capacitance = 7e-5 / 1e9
    time = capacitance / point.chambers[0].flow_pressure
    lag = TransferFunction([time, 1.0], [time, ratio])
    lead = TransferFunction([p["lead_time"], 1.0], [p["lead_ratio"] * p["lead_time"], 1.0])
    frequencies = np.array([0.5, 5.0, 20.0, 50.0, 100.0])
    exact = np.prod([freqresp(f, 2.0 * np.pi * frequencies)[1] for f in (lag, lead)], axis=0)
    sampled = frequency_response(parameters, frequencies)
    np.testing.assert_allclose(np.abs(sampled), np.abs(exact), rtol=0.12)
    np.testing.assert_allclose(np.angle(sampled), np.angle(exact), atol=0.2)


def test_lag_and_lead_go_the_ways_that_their_ratios_say():
    """Below 1 gamma lags, with more gain for slow errors; below 1 alpha leads."""
    slow, fast = frequency_response(changed(lag_ratio=0.1), np.array([0.01, 300.0]))
    assert abs(slow) == pytest.approx(10.0, rel=0.01)
    assert abs(fast) < 3.0
    led = frequency_response(changed(lag_ratio=1.0), np.array([30.0]))
    late = frequency_response(changed(lag_ratio=1.0, lead_ratio=3.0), np.array([30.0]))
    assert np.angle(led) > 0.05
    assert np.angle(late) < -0.05


@given(st.lists(FINITE, min_size=9, max_size=9), st.floats(-20.0, 20.0))
@settings(max_examples=200, deadline=None)
def test_left_and_right_are_mirror_images_and_within_their_limits(measured, overlay):
    angle, speed, torque, left, right, supply, x, v, force = measured
    one, other = (ServoValveController(PARAMETERS, side) for side in ("right", "left"))
    a = one.step(0, angle, speed, torque, left, right, supply, x, v, force, overlay).copy()
    b = other.step(0, -angle, -speed, -torque, right, left, supply, -x, -v, -force, -overlay)
    assert np.array_equal(a, b)
    assert np.all(np.isfinite(a))
    assert -1.0 <= a[1] <= 1.0
    assert np.all(np.isfinite(one.state))


def test_a_plant_at_rest_stays_at_rest():
    plant = Plant(PARAMETERS, "servo_valve")
    sides = [ServoValveController(PARAMETERS, side) for side in ("left", "right")]
    for tick in range(100):
        left, right = (side.step(tick, *plant.out)[1] for side in sides)
        plant.step(tick, 0.0, left, right, 0.0, 0.0, 0.0)
    assert np.ptp(plant.state[6:8]) == 0.0
    assert abs(plant.state[6] - sides[0].out[0]) < 1.0


def test_a_limited_command_does_not_wind_up():
    """A pressure that never comes: the lag takes in no more than what opens the valves fully."""
    controller = ServoValveController(PARAMETERS, "right")
    kept = []
    for tick in range(3000):
        controller.step(tick, 0.0, 0.0, 12.0, 0.0, 0.0, 2e7, 0.0, 0.0, 0.0)
        kept.append(controller.state[0])
    assert controller.out[1] == 1.0
    assert kept[-1] == kept[1000]
    for tick in range(300):
        controller.step(tick, 0.0, 0.0, 0.0, 0.0, 1.5e7, 2e7, 0.0, 0.0, 0.0)
    assert controller.out[1] < 0.0


def grows(parameters, delay, ticks=1500):
    """Whether a push at rest grows in the full simulation, commands ``delay`` ticks late."""
    plant = Plant(parameters.with_values(LOOSE), "servo_valve")
    gain, lead = parameters["driver.gain"], parameters["driver.lead"]
    sides = [ServoValveController(PARAMETERS, side) for side in ("left", "right")]
    sides[0].par = servo_controller_record(parameters, "left")
    sides[1].par = servo_controller_record(parameters, "right")
    rest = tuple(side.out[1] for side in sides)
    way = deque([rest] * (delay + 1), maxlen=delay + 1)
    plant.state[6] += 100.0
    plant.observe(0)
    loads = np.empty(ticks)
    for tick in range(ticks):
        way.append(tuple(float(side.step(tick, *plant.out)[1]) for side in sides))
        driver = -gain * (plant.out[0] + lead * plant.out[1])
        plant.step(tick, driver, *way[0], 0.0, 0.0, 0.0)  # type: ignore[call-arg]
        loads[tick] = plant.state[7] - plant.state[6]
    return np.abs(loads[-200:]).max() > np.abs(loads[200:400]).max()


@pytest.mark.parametrize("delay", [0, 1, 2])
def test_the_limit_of_the_sampled_loop_is_the_simulations(delay):
    """Second route: at rest, 7 % to either side of the predicted gain."""
    limit = largest_servo_gain([servo_point(PARAMETERS, 0.0, 0.0)], delay)
    assert not grows(changed(controller_gain=0.93 * limit), delay)
    assert grows(changed(controller_gain=1.07 * limit), delay)


def test_a_delay_costs_gain():
    points = servo_points(PARAMETERS)
    assert len(points) == 3
    none, one, three = (largest_servo_gain(points, delay) for delay in (0, 1, 3))
    assert 600.0 < none < 800.0
    assert 280.0 < one < 360.0
    assert 120.0 < three < 200.0


def test_unstable_gains_are_refused_with_advice():
    with pytest.raises(ControllerError, match=r"controller_gain 2000 1/s .* at most 7\d\d 1/s"):
        CONTROLLERS["servo_valve"](changed(controller_gain=2000.0), "left")
    check_servo_stability(changed(controller_gain=300.0), delay=1)
    with pytest.raises(ControllerError, match=r"with 2 ticks of delay"):
        check_servo_stability(changed(controller_gain=300.0), delay=2)
    with pytest.raises(ControllerError, match=r"supply_pressure .* too low"):
        check_servo_stability(PARAMETERS.with_values({"closed_centre.supply_pressure": 5.1e6}))


def test_the_matrix_is_the_controller_itself():
    """Perturb the compiled controller tick by tick and compare with the matrix."""
    torque, speed = 1.0, 0.02
    point = servo_point(PARAMETERS, torque, speed)
    matrix = servo_loop_matrix(point, PARAMETERS["servo_valve.controller_gain"])
    assert servo_spectral_radius(point, PARAMETERS["servo_valve.controller_gain"]) < 1.0
    right, left = (chamber.pressure for chamber in point.chambers)
    sides = [ServoValveController(PARAMETERS, side) for side in ("right", "left")]
    gear = PARAMETERS["mechanics.gear_ratio"]
    state = np.zeros(len(matrix))
    state[4], state[7] = 20.0, -10.0
    plant, steady, pairs = state[:10].copy(), np.zeros(2), []
    for tick in range(-400, 12):
        moved = plant if tick >= 0 else np.zeros(10)
        turned = torque + float(point.torque_row @ moved)
        pressures = left + moved[7], right + moved[4]
        wheel = gear * speed + moved[1]
        commands = np.array(
            [
                side.step(0, 0.0, wheel, turned, *pressures, 2e7, 0.0, speed + moved[3], 0.0)[1]
                for side in sides
            ]
        )
        if tick == -1:
            steady = commands
        if tick >= 0:
            plant = point.transition @ plant + point.input @ (commands - steady)
            state = matrix @ state
            pairs.append((plant, state[:10]))
    actual, expected = np.array(pairs).transpose(1, 0, 2)
    largest = np.abs(expected).max(axis=0)
    np.testing.assert_allclose(actual / largest, expected / largest, atol=5e-3)


def test_the_linear_plant_is_the_simulations():
    """A small command's effect on the pressure, from the linear model and from the plant."""
    plant = Plant(PARAMETERS.with_values(LOOSE), "servo_valve")
    point = servo_point(PARAMETERS, 0.0, 0.0)
    rest = ServoValveController(PARAMETERS, "left").out[1]
    start, small, linear = plant.state[7], 1e-4, []
    state = np.zeros(10)
    a = np.array(point.transition)
    for tick in range(6):
        state = a @ state + point.input @ np.array([small, 0.0])
        linear.append(state[4])
        # The driver of the linear model holds the wheel, which hardly moves in six ticks.
        plant.step(tick, 0.0, rest, rest + small, 0.0, 0.0, 0.0)
        assert plant.state[7] - start == pytest.approx(linear[-1], rel=0.03)


def test_dlsim_agrees_with_the_sampled_lead():
    """The lead alone against scipy's simulation of its pulse transfer function."""
    controller = ServoValveController(changed(lag_ratio=1.0), "right")
    p = controller.par[0]
    errors = np.random.default_rng(3).normal(size=50)
    got = []
    for error in errors:
        led, controller.state[0] = lead_lag(p, controller.state, error)
        got.append(led)
    gain = float(p["lead_gain"])
    system = ([gain, -gain * float(p["lead_zero"])], [1.0, -float(p["lead_pole"])], TICK_PERIOD)
    np.testing.assert_allclose(got, dlsim(system, errors)[1][:, 0], rtol=1e-12)
