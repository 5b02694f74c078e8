import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from steering_core.parameters import load_parameters
from vehicle_model.bicycle import (
    checked_speed,
    continuous,
    kinematic_gains,
    rack_force_gains,
    tyre_gains,
    understeer_gradient,
    yaw_rate_gain,
)

P = load_parameters().group("vehicle")
WHEELBASE = 2.7
SPEEDS = [0.5, 2.0, 5.0, 10.0, 19.444, 30.0, 60.0]


def steady_state(p, speed: float, x: float) -> np.ndarray:
    """Return sideslip and curvature where the equations of motion are in balance."""
    a_matrix, b_vector = continuous(p, speed)
    return np.linalg.solve(a_matrix[:2, :2], -b_vector[:2] * x)


def test_understeer_gradient_by_hand():
    """m (b C_r - a C_f) / (l C_f C_r) with the data sheet's numbers: the car understeers."""
    expected = 1850.0 * (1.5 * 135e3 - 1.2 * 115e3) / (2.7 * 115e3 * 135e3)
    assert understeer_gradient(P) == pytest.approx(expected)
    assert 0.0 < expected < 0.005


@pytest.mark.parametrize("speed", SPEEDS)
@pytest.mark.parametrize("angle", [-0.05, 0.01, 0.1])
def test_steady_yaw_rate_meets_the_closed_form(speed, angle):
    _, curvature = steady_state(P, speed, angle * P["steering_arm"])
    assert speed * curvature == pytest.approx(yaw_rate_gain(P, speed) * angle, rel=1e-9)


@pytest.mark.parametrize("speed", SPEEDS)
def test_angle_to_yaw_rate_to_angle(speed):
    """Round trip through delta = l / R + K_us a_y."""
    angle = 0.02
    yaw_rate = yaw_rate_gain(P, speed) * angle
    back = WHEELBASE * yaw_rate / speed + understeer_gradient(P) * speed * yaw_rate
    assert back == pytest.approx(angle)


@pytest.mark.parametrize("speed", SPEEDS)
def test_steady_tyre_forces_carry_the_centripetal_force_in_the_ratio_of_the_arms(speed):
    x = 0.004
    sideslip, curvature = steady_state(P, speed, x)
    front, rear = (gains @ np.array([sideslip, curvature, x]) for gains in tyre_gains(P))
    centripetal = P["mass"] * speed**2 * curvature
    assert front + rear == pytest.approx(centripetal, rel=1e-9)
    assert front / centripetal == pytest.approx(1.5 / 2.7, rel=1e-9)
    assert front > 0.0


def test_slip_at_both_axles_by_hand():
    """Turning left about the rear axle: v_y = b r, the front wheel points along its own path."""
    front, rear = tyre_gains(P)
    states = np.array([1.5 * 0.01, 0.01, 2.7 * 0.01 * 0.11])
    assert front @ states == pytest.approx(0.0, abs=1e-9)
    assert rear @ states == pytest.approx(0.0, abs=1e-9)
    assert front @ np.array([0.0, 0.0, 0.11]) == pytest.approx(115e3)


def test_direct_stiffness_at_the_rack():
    """C_f n / arm^2: 0.76 MN/m, and it takes both parts of the trail."""
    gains = rack_force_gains(P)
    assert gains[2] == pytest.approx(115e3 * 0.08 / 0.11**2)
    assert gains[2] == pytest.approx(0.76e6, rel=1e-3)
    half = rack_force_gains({**P, "mechanical_trail": 0.0})
    assert half == pytest.approx(gains / 2.0)


def test_slow_car_rolls_where_its_wheels_point():
    sideslip, curvature = steady_state(P, 1e-3, 0.0022)
    assert kinematic_gains(P) * 0.0022 == pytest.approx([sideslip, curvature], rel=1e-6)
    assert curvature == pytest.approx(0.02 / 2.7, rel=1e-6)


@pytest.mark.parametrize("speed", [-1e-9, -20.0, float("nan"), float("inf"), -float("inf")])
def test_impossible_speeds_are_refused(speed):
    with pytest.raises(ValueError, match="speed must be finite and not negative"):
        checked_speed(speed)


cars = st.fixed_dictionaries(
    {
        "mass": st.floats(500.0, 40e3),
        "yaw_inertia": st.floats(500.0, 300e3),
        "front_axle_distance": st.floats(0.5, 4.0),
        "rear_axle_distance": st.floats(0.5, 4.0),
        "front_cornering_stiffness": st.floats(2e4, 1e6),
        "rear_cornering_stiffness": st.floats(2e4, 1e6),
        "steering_arm": st.floats(0.05, 0.4),
    }
)


@settings(max_examples=100, deadline=None)
@given(cars, st.floats(0.1, 80.0))
def test_any_car_below_its_critical_speed_is_stable_and_meets_the_closed_form(car, speed):
    gradient = understeer_gradient(car)
    length = car["front_axle_distance"] + car["rear_axle_distance"]
    eigenvalues = np.linalg.eigvals(continuous(car, speed)[0][:2, :2])
    margin = length + gradient * speed**2
    if abs(margin) < 1e-3 * length:
        return
    # The characteristic polynomial's last coefficient has the sign of l + K_us v^2.
    assert (eigenvalues.real.max() < 0.0) == (margin > 0.0)
    _, curvature = steady_state(car, speed, car["steering_arm"])
    assert curvature == pytest.approx(1.0 / margin, rel=1e-6)
