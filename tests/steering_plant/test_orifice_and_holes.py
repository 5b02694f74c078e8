"""Orifice flow and the drilled holes: odd, monotone, and their gradients consistent."""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.integrate import quad

from steering_plant.control_valve import holes_area, holes_area_gradient
from steering_plant.orifice import orifice_flow, orifice_flow_gain

drops = st.floats(-3e7, 3e7)
transitions = st.floats(1e2, 1e6)
DIAMETER = 2.3e-3


@given(drops, transitions)
def test_flow_is_odd(drop, transition):
    assert orifice_flow(1e-8, -drop, transition) == -orifice_flow(1e-8, drop, transition)


@given(drops, drops, transitions)
def test_flow_rises_with_the_drop(first, second, transition):
    low, high = sorted((first, second))
    assert orifice_flow(1e-8, low, transition) <= orifice_flow(1e-8, high, transition)
    assert orifice_flow_gain(1e-8, low, transition) > 0.0


@given(st.floats(1e5, 3e7))
def test_flow_is_turbulent_far_above_the_transition(drop):
    assert orifice_flow(2e-8, drop, 1e3) == pytest.approx(2e-8 * math.sqrt(drop), rel=1e-4)


@given(drops, transitions)
def test_the_flow_gain_is_the_derivative(drop, transition):
    step = 1e-3 * math.hypot(drop, transition)
    rise = orifice_flow(1.0, drop + step, transition) - orifice_flow(1.0, drop - step, transition)
    assert rise / (2.0 * step) == pytest.approx(orifice_flow_gain(1.0, drop, transition), rel=1e-4)


@given(st.floats(-1e-3, 4e-3), st.floats(0.0, 1e-3))
def test_the_opening_never_shrinks_with_the_spool(depth, further):
    assert holes_area(DIAMETER, depth) <= holes_area(DIAMETER, depth + further) * (1.0 + 1e-15)


@given(st.floats(1e-9, 0.99 * DIAMETER))
def test_the_opening_is_the_segments_area(depth):
    """The chord integrated, with the root at the edge taken out by depth = s^2."""
    chord = lambda s: 4.0 * s * s * math.sqrt(DIAMETER - s * s)  # noqa: E731
    exact, _ = quad(chord, 0.0, math.sqrt(depth), epsabs=0.0, epsrel=1e-11)
    assert holes_area(DIAMETER, depth) == pytest.approx(4.0 * exact, rel=1e-9)


@given(st.floats(1e-5, DIAMETER - 1e-5))
def test_the_area_gradient_is_the_derivative(depth):
    step = 1e-8
    rise = holes_area(DIAMETER, depth + step) - holes_area(DIAMETER, depth - step)
    gradient = holes_area_gradient(DIAMETER, depth)
    assert rise / (2.0 * step) == pytest.approx(gradient, rel=1e-5)


def test_a_covered_hole_is_shut_and_a_free_one_whole():
    assert holes_area(DIAMETER, -1e-6) == 0.0 == holes_area(DIAMETER, 0.0)
    whole = math.pi * DIAMETER**2
    assert holes_area(DIAMETER, DIAMETER) == pytest.approx(whole, rel=1e-15)
    assert holes_area(DIAMETER, 1.0) == pytest.approx(whole, rel=1e-15)
    assert holes_area_gradient(DIAMETER, 2.0 * DIAMETER) == 0.0
    around = [holes_area(DIAMETER, 0.5 * DIAMETER * (1.0 + sign * 1e-15)) for sign in (-1, 1)]
    assert np.diff(around)[0] < 1e-14 * whole
