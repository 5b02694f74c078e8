import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays
from scipy.integrate import solve_ivp
from scipy.linalg import expm

from vehicle_model.sampling import exponential, first_order_hold

# Small enough that neither route loses digits to cancellation.
entries = st.floats(-3.0, 3.0)


@settings(max_examples=100, deadline=None)
@given(arrays(np.float64, (3, 3), elements=entries))
def test_exponential_agrees_with_scipy(matrix):
    assert exponential(matrix) == pytest.approx(expm(matrix), rel=1e-9, abs=1e-10)


def test_exponential_of_zero_and_of_a_very_fast_decay():
    assert (exponential(np.zeros((2, 2))) == np.eye(2)).all()
    assert (exponential(np.diag([-1e12, -1e3])) == 0.0).all()


def test_first_order_hold_follows_the_differential_equation():
    """A singular A, a ramp that does not start at zero: compared with a tight integration."""
    a_matrix = np.array([[-3.0, 2.0, 0.0], [1.0, -40.0, 0.0], [5.0, 1.0, 0.0]])
    b_vector = np.array([1.0, -2.0, 0.5])
    period, start, end, z0 = 0.07, 0.3, -1.1, np.array([0.2, -0.4, 1.0])
    s = first_order_hold(a_matrix, b_vector, period)
    found = s.transition @ z0 + s.held * start + s.slope * (end - start)

    def rate(t, z):
        return a_matrix @ z + b_vector * (start + (end - start) * t / period)

    expected = solve_ivp(rate, (0.0, period), z0, rtol=1e-12, atol=1e-14, method="DOP853").y[:, -1]
    assert found == pytest.approx(expected, rel=1e-10)


def test_two_half_periods_make_a_whole_one():
    a_matrix, b_vector = np.array([[-2.0, 1.0], [0.0, -900.0]]), np.array([1.0, 3.0])
    whole, half = (first_order_hold(a_matrix, b_vector, h) for h in (0.01, 0.005))
    z0, start, rise = np.array([1.0, -1.0]), 0.4, 0.6
    middle = half.transition @ z0 + half.held * start + half.slope * rise / 2.0
    end = half.transition @ middle + half.held * (start + rise / 2.0) + half.slope * rise / 2.0
    expected = whole.transition @ z0 + whole.held * start + whole.slope * rise
    assert end == pytest.approx(expected, rel=1e-12)
