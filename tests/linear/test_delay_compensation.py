"""The controller that knows its delay: linear matrix against kernel, and what it gains."""

import numpy as np
import pytest

from pressure_control.controller import ValveController
from pressure_control.operating_point import steering_point
from pressure_control.sampled_loop import loop_matrix, spectral_radius
from pressure_control.stability import (
    ControllerError,
    check_sampled_stability,
    largest_stable_resonance,
    operating_points,
)
from steering_bringup.direct.loop import see_spool
from steering_core.parameters import load_parameters
from steering_plant.boost_curve import FORMULA

PARAMETERS = load_parameters()


def changed(**values):
    return PARAMETERS.with_values({f"valve_controller.{n}": v for n, v in values.items()})


def test_one_known_tick_of_delay_costs_a_quarter_instead_of_more_than_half_of_the_resonance():
    plain = largest_stable_resonance(operating_points(PARAMETERS), 3000.0, 1.2, 1)
    known = changed(delay_compensation=1.0)
    predicted = largest_stable_resonance(operating_points(known), 3000.0, 1.2, 1)
    assert plain == pytest.approx(890.0, rel=0.03)
    assert predicted == pytest.approx(1490.0, rel=0.03)


@pytest.mark.parametrize("ticks", [1, 2, 3])
def test_kernel_follows_the_matrix(ticks):
    """A pressure error at constant torque: demands of kernel and of matrix, tick by tick."""
    parameters = changed(delay_compensation=float(ticks), resonance=500.0, torque_lowpass=2e-3)
    point = steering_point(parameters, FORMULA, 1.0, 0.02, 0.0)
    matrix = loop_matrix(point, 500.0, 1.2, ticks)
    right, left = (chamber.valve for chamber in point.chambers)
    sides = [ValveController(parameters, side) for side in ("right", "left")]
    area = sides[0].par[0]["pressure_area"]
    state, gear = np.zeros(len(matrix)), PARAMETERS["mechanics.gear_ratio"]
    state[7], steady = 20.0, np.zeros(2)
    moved = np.zeros(12)
    for tick in range(-400, 12):
        moved = state[:12] if tick >= 0 else moved
        torque = 1.0 + float(point.torque_row @ moved)
        measured = (
            0.0,
            gear * 0.02 + moved[1],
            torque,
            left.pressure + moved[11],
            right.pressure + moved[7],
            right.supply,
            0.0,
            0.02 + moved[3],
            0.0,
        )
        demands = np.array([side.step(tick + 400, *measured)[1] / area for side in sides])
        if tick < 0:
            steady = demands
            continue
        state = matrix @ state
        # a demand enters the queue of those on their way as the latest
        np.testing.assert_allclose(demands - steady, state[17:19], atol=0.02 * 20.0, rtol=0.02)


def test_stability_is_judged_at_the_delay_that_is_compensated():
    late = changed(delay_compensation=1.0)
    check_sampled_stability(late)
    with pytest.raises(ControllerError, match="with 2 ticks"):
        check_sampled_stability(late, delay=2)
    for wrong in (0.5, 8.0):
        with pytest.raises(ControllerError, match="whole number of ticks up to 7"):
            ValveController(changed(delay_compensation=wrong), "left")


def test_neutral_options_change_no_bit():
    measured = (0.1, 0.3, 1.2, 5e5, 6e5, 2e7, 1e-3, 2e-3, 0.0)
    plain, seeing = ValveController(PARAMETERS, "right"), ValveController(PARAMETERS, "right")
    see_spool((0, 0, seeing.state), np.full(15, 1e-4), 12)
    for tick in range(20):
        np.testing.assert_array_equal(plain.step(tick, *measured), seeing.step(tick, *measured))


def test_a_seen_spool_sets_the_schedule():
    sensed = ValveController(changed(spool_sensor=1.0), "right")
    forces = []
    for spool in (1e-5, 2e-4):
        sensed.state[:] = 0.0
        see_spool((0, 0, sensed.state), np.full(15, spool), 12)
        forces.append(float(sensed.step(0, 0.0, 0.0, 1.0, 4e5, 5e5, 2e7, 0.0, 0.0, 0.0)[1]))
    # wider open the valve answers more, so the controller asks for less
    assert forces[1] < forces[0]


def test_a_low_pass_on_the_torque_costs_margin():
    radius = [
        spectral_radius(
            steering_point(changed(torque_lowpass=t), FORMULA, 2.85, 0.001, 0.0), 1200.0, 1.2
        )
        for t in (0.0, 4e-3)
    ]
    assert radius[1] > radius[0]
