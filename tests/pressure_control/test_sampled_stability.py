"""The stability check: calibrated on the full simulation, quick, and clear in what it says."""

import time

import numpy as np
import pytest

from pressure_control.controller import ValveController
from pressure_control.operating_point import steering_point
from pressure_control.sampled_loop import loop_matrix
from pressure_control.stability import ControllerError, check_sampled_stability
from steering_core.parameters import load_parameters
from steering_plant.boost_curve import FORMULA

PARAMETERS = load_parameters()


def changed(**values):
    return PARAMETERS.with_values({f"valve_controller.{n}": v for n, v in values.items()})


CONSTANT = {"resonance_fall_pressure": 0.0, "velocity_lowpass": 0.01}
FAST = {"resonance_fall_pressure": 0.0, "velocity_lowpass": 0.005}

QUIET = [
    ({}, 0),
    ({"resonance": 800.0}, 1),
    ({"resonance": 1700.0}, 0),
    ({"damping": 0.7}, 0),
    ({"damping": 4.0}, 0),
    ({"resonance": 175.0}, 0),
    ({"resonance": 700.0, **CONSTANT}, 0),
    ({"resonance": 800.0, **CONSTANT}, 0),
    ({"resonance": 175.0, **CONSTANT}, 0),
    ({"resonance": 700.0, **FAST}, 0),
]
"""Settings and delays at which the full simulation's on-centre manoeuvre is quiet."""

CYCLING = [
    ({"resonance": 2400.0}, 0),
    ({}, 1),
    ({"damping": 0.3}, 0),
    ({"resonance": 900.0, **CONSTANT}, 0),
    ({"resonance": 1000.0, **CONSTANT}, 0),
    ({"resonance": 800.0, **FAST}, 0),
]
"""Settings and delays at which it rings or goes into a limit cycle."""


@pytest.mark.parametrize(("values", "delay"), QUIET)
def test_quiet_settings_pass(values, delay):
    check_sampled_stability(changed(**values), delay=delay)


@pytest.mark.parametrize(("values", "delay"), CYCLING)
def test_cycling_settings_are_refused(values, delay):
    with pytest.raises(ControllerError, match=r"valve_controller\.resonance"):
        check_sampled_stability(changed(**values), delay=delay)


def test_the_advice_is_stable_and_close_to_the_limit():
    with pytest.raises(ControllerError) as error:
        check_sampled_stability(changed(resonance=1000.0, **CONSTANT))
    text = str(error.value)
    assert "valve_controller.damping 1.2" in text
    largest = float(text.split("at most ")[1].split(" rad/s")[0])
    assert 800.0 < largest < 870.0
    check_sampled_stability(changed(resonance=0.999 * largest, **CONSTANT))
    with pytest.raises(ControllerError):
        check_sampled_stability(changed(resonance=1.05 * largest, **CONSTANT))


def test_a_controller_is_not_made_with_an_unstable_choice():
    with pytest.raises(ControllerError, match="unstable at 1 kHz"):
        ValveController(changed(resonance=3000.0), "left")


@pytest.mark.parametrize("resonance", [1e5, 1e150, 1e300])
def test_absurd_resonances_get_the_same_advice(resonance):
    with pytest.raises(ControllerError, match=r"at most 2\.\d\de\+03 rad/s is stable"):
        check_sampled_stability(changed(resonance=resonance))


def test_a_supply_that_holds_no_point_of_the_curve_is_refused():
    """Without a point to judge by, any resonance at all once passed."""
    with pytest.raises(ControllerError, match=r"closed_centre\.supply_pressure .* too low"):
        check_sampled_stability(PARAMETERS.with_values({"closed_centre.supply_pressure": 2e5}))


def test_a_nominal_displacement_inside_the_overlap_is_refused():
    overlapped = PARAMETERS.with_values({"pressure_control_valve.underlap": -3e-5})
    with pytest.raises(ControllerError, match="nominal_spool_displacement"):
        check_sampled_stability(overlapped)


def test_check_takes_less_than_50_ms_of_the_processor():
    check_sampled_stability(PARAMETERS)
    begin = time.process_time()
    for _ in range(4):
        check_sampled_stability(PARAMETERS)
    assert (time.process_time() - begin) / 4 < 0.05


def test_matrix_is_the_controller_itself():
    """Second route: perturb the compiled controller tick by tick and compare with the matrix."""
    torque, speed, ticks = 1.0, 0.02, 12
    point = steering_point(PARAMETERS, FORMULA, torque, speed, 0.0)
    p = PARAMETERS.group("valve_controller")
    matrix = loop_matrix(point, p["resonance"], p["damping"])
    right, left = (chamber.valve for chamber in point.chambers)
    state = np.zeros(len(matrix))
    state[7], state[11] = 20.0, -10.0  # chamber pressures, Pa, from the operating point

    sides = [ValveController(PARAMETERS, side) for side in ("right", "left")]
    gear = PARAMETERS["mechanics.gear_ratio"]
    area = sides[0].par[0]["pressure_area"]
    plant, steady = state[:12].copy(), None
    for tick in range(-400, ticks):
        moved = plant if tick >= 0 else np.zeros(12)
        turned = torque + float(point.torque_row @ moved)
        demands = []
        for side in sides:
            force = side.step(
                max(tick, 0),
                0.0,
                gear * speed + moved[1],
                turned,
                left.pressure + moved[11],
                right.pressure + moved[7],
                right.supply,
                0.0,
                speed + moved[3],
                0.0,
            )[1]
            demands.append(force / area)
        if tick == -1:
            steady = np.array(demands)
        if tick >= 0:
            plant = point.transition @ plant + point.input @ (np.array(demands) - steady)
            state = matrix @ state
            scale = np.abs(state[:12]) + 1e-6 * np.abs(state[:12]).max()
            np.testing.assert_allclose(plant / scale, state[:12] / scale, atol=2e-2)
