"""Linear open-centre models: against the right-hand side's differences and the simulation."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from steering_core.parameters import ParameterError, load_parameters
from steering_plant.linear.gear import assistance, gear_with, linear_gear, tyre_stiffness
from steering_plant.linear.jacobian import numerical_model
from steering_plant.linear.open_centre import (
    open_centre_point,
    source_gains,
    source_model,
    whole_model,
)
from steering_plant.model import states
from steering_plant.plant import Plant
from steering_studies.linear.open_centre_study import parting
from steering_studies.linear.small_signal import LOCKED, small_signal, without_friction

PARAMETERS = load_parameters()
QUIET = without_friction(PARAMETERS)
PLANT = Plant(QUIET, "open_centre")
NAMES = ("pump_pressure", "right_pressure", "left_pressure")


def placed(point):
    """The plant's state at an operating point of the valve."""
    y = PLANT.state.copy()
    p = QUIET.group("mechanics")
    y[states.POSITION] = point.rack_position
    y[states.VELOCITY] = point.load_flow / p["piston_area"]
    y[states.ANGLE] = point.torque / p["torsion_bar_stiffness"]
    y[states.ANGLE] += p["gear_ratio"] * point.rack_position
    y[states.LEFT], y[states.RIGHT], y[states.PUMP] = point.left, point.right, point.pump
    return y


@settings(max_examples=25, deadline=None)
@given(st.floats(-4.0, 4.0), st.floats(-0.5, 0.5), st.floats(-0.05, 0.05))
def test_whole_linearisation_is_the_right_hand_sides_slope(torque, share, position):
    """Any torque, flow and rack position; the areas' kink at 0 N m allows for its neighbourhood."""
    if abs(torque) < 0.01:
        torque = 0.01
    flow = share * PARAMETERS["open_centre.pump_flow"]
    point = open_centre_point(QUIET, torque, flow, position)
    model = whole_model(point)
    slopes = numerical_model(PLANT, placed(point), np.zeros(states.INPUTS))
    rows = [slopes.states.index(name) for name in NAMES]
    np.testing.assert_allclose(slopes.a[np.ix_(rows, rows)], model.a, rtol=1e-5, atol=1e-4)
    by_torque = slopes.a[rows, states.ANGLE] / QUIET["mechanics.torsion_bar_stiffness"]
    np.testing.assert_allclose(by_torque, model.b[:, 0], rtol=1e-4)
    np.testing.assert_allclose(slopes.a[rows, states.VELOCITY], model.b[:, 1], rtol=1e-6)


@pytest.mark.parametrize("torque", [0.0, 2.0, 4.0])
def test_nonlinear_small_signal_agrees_within_1_db_and_5_degrees(torque):
    for stiffness in (LOCKED, None):
        found = small_signal(PARAMETERS, "open_centre", torque, stiffness=stiffness, settle=1000)
        model = whole_model(open_centre_point(PARAMETERS, torque))
        responses = assistance(model, 2.0 * np.pi * found.frequency)
        assert found.frequency[-1] == pytest.approx(100.0)
        if stiffness == LOCKED:
            ratio = found.pressure_by_torque / responses.by_torque
        else:
            ratio = found.rack_by_wheel / linear_gear(PARAMETERS).closed_loop(responses)
        assert np.max(np.abs(20.0 * np.log10(np.abs(ratio)))) < 0.1
        assert np.max(np.abs(np.degrees(np.angle(ratio)))) < 0.5


def test_static_gain_is_the_boost_curves_slope():
    """fig 4.5's axis: 100 to 140 dB; the formula's slope by hand."""
    for torque in (0.5, 2.0, 4.0):
        slope = 2.17e5 * 0.94 * np.exp(0.94 * torque)
        model = whole_model(open_centre_point(PARAMETERS, torque))
        static = -model.c @ np.linalg.solve(model.a, model.b)
        assert static[0, 0] == pytest.approx(slope, rel=2e-3)
        gains = source_gains(open_centre_point(PARAMETERS, torque))
        assert gains.K_q / gains.K_c == pytest.approx(slope, rel=2e-3)
        assert 100.0 < 20.0 * np.log10(slope) < 140.0


def test_source_model_has_its_resonance_and_damping():
    point = open_centre_point(PARAMETERS, 3.0)
    gains, poles = source_gains(point), source_model(point).poles()
    assert np.prod(poles).real == pytest.approx(gains.w_0**2)
    assert -np.sum(poles).real == pytest.approx(2.0 * gains.d_0 * gains.w_0)


def test_where_the_source_parts_from_the_whole_linearisation():
    """Within 1 dB and 5 degrees up to 2 N m; beyond it leaves at 18 Hz (3 N m), 7 Hz (4 N m)."""
    found = parting(PARAMETERS)
    assert np.all(np.isnan(found.leaves[:3]))
    assert found.leaves[3] == pytest.approx(17.6, rel=0.05)
    assert found.leaves[4] == pytest.approx(6.7, rel=0.05)
    assert found.decibel[4] == pytest.approx(1.35, abs=0.1)


def test_gears_poles_close_the_loop_that_is_drawn():
    """A held wheel's poles are the zeros of 1 + loop gain."""
    gear = linear_gear(PARAMETERS)
    model = whole_model(open_centre_point(PARAMETERS, 2.0))
    for pole in gear_with(model, gear, hands_free=False).poles():
        s = complex(pole)
        inner = np.linalg.solve(s * np.eye(3) - model.a, model.b)
        by_torque, by_speed = (model.c[0] @ inner)[:2]
        push = gear.K_T * gear.R_T * (gear.R_T + gear.A_p * by_torque)
        rack = gear.M * s * s + (gear.b - gear.A_p * by_speed) * s + gear.stiffness
        assert abs(push + rack) < 1e-6 * (abs(push) + abs(rack))
    assert tyre_stiffness(PARAMETERS) == pytest.approx(0.76e6, rel=0.01)


def test_a_flow_beyond_the_pumps_is_refused_in_one_line():
    with pytest.raises(ParameterError, match="no steady state"):
        open_centre_point(PARAMETERS, 1.0, 3e-4)
