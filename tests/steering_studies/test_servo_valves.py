"""Figures 7.2, 7.8 to 7.10, 8.7 and 8.8 of the source, within the tolerances of the targets."""

import numpy as np
import pytest

from steering_studies import servo_valves

BAR = 1e5
AS_PRINTED = {"servo_valve.flow_feed_forward": 0.0}


def test_figure_8_7_63_percent_in_8_to_9_ms_both_ways():
    step = servo_valves.step()
    assert 0.9 * 8e-3 < step.rise < 1.1 * 9e-3
    assert 0.9 * 8e-3 < step.fall < 1.1 * 9e-3
    assert step.overshoot < 0.5 * BAR
    assert np.array_equal(step.left, step.right)


def test_figures_7_8_to_7_10_with_feed_forward():
    """Torque within +-0.25 N m; nearer to the open-centre valve than to the reference."""
    sine = servo_valves.sine()
    assert 15.0 * BAR < np.abs(sine.open_centre).max() < 22.0 * BAR
    assert sine.torque_difference < 0.25
    assert sine.open_centre_error < 0.5 * sine.reference_error
    assert sine.reference_error < 3.5 * BAR


def test_figure_7_10_is_not_reached_by_7_15_alone():
    """As printed, without a feed-forward, and at the gain that figure 8.7 needs."""
    sine = servo_valves.sine(AS_PRINTED)
    assert 0.30 < sine.torque_difference < 0.45
    faster = servo_valves.sine(AS_PRINTED | {"servo_valve.controller_gain": 200.0})
    assert faster.torque_difference < 0.25
    assert servo_valves.step({"servo_valve.controller_gain": 200.0}).rise < 0.9 * 8e-3


def test_figure_7_10_the_difference_exists_only_while_the_wheel_moves():
    held = servo_valves.sine({}).torque[:200]  # the sweep begins with a frequency of zero
    assert np.abs(held).max() < 0.02


@pytest.mark.parametrize("forward", [0.0, 1.0])
def test_figure_7_2_the_load_follows_up_to_3_kilonewton(forward):
    force = servo_valves.load_force({"load_force_controller.speed_feed_forward": forward})
    assert force.largest > 3000.0
    assert force.error < (0.02 if forward else 0.12) * force.largest


def test_figure_8_8_the_valves_follow_and_filter_the_jerks():
    driven = servo_valves.on_centre()
    assert 12.0 * BAR < np.abs(driven.measured).max() < 20.0 * BAR
    assert driven.error < 0.5 * BAR
    assert driven.pressure_jerks < 0.5 * driven.reference_jerks


def test_the_rig_with_its_load_cylinder_is_as_close_to_the_open_centre_valve():
    assert servo_valves.sine(node_set="servo_rig").torque_difference < 0.25
