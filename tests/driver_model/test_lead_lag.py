import numpy as np
import pytest
from scipy.signal import cont2discrete, lfilter

from driver_model.lead_lag import sampled_lead_lag
from steering_core.parameters import load_parameters

GAIN, LEAD, LAG = 300.0, 0.025, 0.0025
PERIOD = 0.001


def run(coefficients: dict[str, float], errors: np.ndarray) -> np.ndarray:
    """Filter ``errors`` by the difference equation that the docstring states."""
    c, lag_output, previous, torques = coefficients, 0.0, 0.0, []
    for error in errors:
        lag_output = (
            c["decay"] * lag_output + c["previous_weight"] * previous + c["present_weight"] * error
        )
        torques.append(c["gain"] * (c["direct"] * error + lag_output))
        previous = error
    return np.array(torques)


def test_the_data_sheet_holds_the_values_used_here():
    values = load_parameters().group("driver")
    assert (values["gain"], values["lead"], values["lag"]) == (GAIN, LEAD, LAG)
    assert values["maximum_torque"] == 50.0


def test_matches_the_first_order_hold_of_scipy():
    """Second route: scipy discretises the whole transfer function."""
    errors = np.cumsum(np.random.default_rng(3).normal(size=400)) * 1e-3
    numerator, denominator, _ = cont2discrete(
        ([GAIN * LEAD, GAIN], [LAG, 1.0]), PERIOD, method="foh"
    )
    expected = lfilter(numerator.ravel(), denominator, errors)
    torques = run(sampled_lead_lag(GAIN, LEAD, LAG, PERIOD), errors)
    assert torques == pytest.approx(expected, rel=1e-9, abs=1e-9)


def test_a_constant_error_gives_the_gain_and_a_ramp_the_lead():
    """T = gain (e + (lead - lag) e') once the lag has settled; exact for the first-order hold."""
    coefficients = sampled_lead_lag(GAIN, LEAD, LAG, PERIOD)
    assert run(coefficients, np.full(60, 0.1))[-1] == pytest.approx(GAIN * 0.1, rel=1e-9)
    ramp = 0.5 * np.arange(60) * PERIOD
    assert run(coefficients, ramp)[-1] == pytest.approx(GAIN * (ramp[-1] + (LEAD - LAG) * 0.5))


def test_equal_lead_and_lag_are_a_plain_gain():
    errors = np.sin(np.arange(100.0))
    assert run(sampled_lead_lag(GAIN, LAG, LAG, PERIOD), errors) == pytest.approx(GAIN * errors)


def test_a_vanishing_lag_is_a_lead_by_backward_difference():
    """T = gain (e + lead (e(k) - e(k-1)) / period): bounded, although lead / lag is not."""
    errors = np.array([1.0, 1.0, 0.5])
    torques = run(sampled_lead_lag(GAIN, 0.01, 1e-9, PERIOD), errors)
    assert torques == pytest.approx([3300.0, 300.0, 150.0 - 1500.0], rel=1e-6)


def test_an_endless_lag_leaves_the_direct_term():
    torques = run(sampled_lead_lag(GAIN, 1.0, 1e3, PERIOD), np.array([1.0, 1.0]))
    assert torques == pytest.approx(0.3, rel=1e-2)


def open_loop(wheel, frequency: np.ndarray, delay: int) -> np.ndarray:
    """Return the loop gain of driver and wheel at ``frequency`` [rad/s], output hold included."""
    c = sampled_lead_lag(GAIN, LEAD, LAG, PERIOD)
    z = np.exp(1j * frequency * PERIOD)
    lag = (c["present_weight"] * z + c["previous_weight"]) / (z - c["decay"])
    angles = [np.linalg.solve(w * np.eye(2) - wheel.transition, wheel.by_torque)[0] for w in z]
    return c["gain"] * (c["direct"] + lag) * np.array(angles) * z**-delay


@pytest.mark.parametrize(("delay", "phase", "gain"), [(0, 51.0, 22.8), (1, 43.5, 13.8)])
def test_margins_are_the_documented_ones(wheel, delay, phase, gain):
    frequency = np.geomspace(50.0, 3000.0, 4000)
    loop = open_loop(wheel, frequency, delay)
    magnitude, angle = np.abs(loop), np.degrees(np.unwrap(np.angle(loop)))
    angle -= 360.0 * np.ceil(angle[0] / 360.0)
    crossover = np.flatnonzero(magnitude > 1.0)[-1]
    turning = np.flatnonzero(angle < -180.0)[0]
    assert 180.0 + angle[crossover] == pytest.approx(phase, abs=0.5)
    assert -20.0 * np.log10(magnitude[turning]) == pytest.approx(gain, abs=0.2)
