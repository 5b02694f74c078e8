"""Linear pressure control: block diagrams, criterion, steering loops, servo valves."""

import numpy as np
import pytest

from pressure_control.linear_assistance import closed_centre_assistance, valve_responses
from pressure_control.linear_servo import linear_servo, servo_controller
from pressure_control.linear_valve import linearise
from pressure_control.valve_diagram import corners, general_response
from pressure_control.valve_static import holding_demand, pressure_under_flow
from steering_core.parameters import load_parameters
from steering_plant.linear.gear import linear_gear
from steering_plant.linear.jacobian import numerical_model
from steering_plant.model import states
from steering_plant.plant import Plant
from steering_plant.rest import rest_solenoid_force
from steering_studies.linear import steering_study, valve_study
from steering_studies.linear.small_signal import small_signal, without_friction

PARAMETERS = load_parameters()


@pytest.mark.parametrize("pressure", [5e5, 50e5])
def test_the_source_diagram_is_the_state_space(pressure):
    for flow in (-3e-5, 0.0, 3e-5):
        valve = linearise(PARAMETERS, pressure, flow=flow)
        s = 1j * np.logspace(0.0, 4.0, 60)
        np.testing.assert_allclose(general_response(valve, s), valve_responses(valve, s.imag)[0])


def test_the_criterion_is_where_the_oils_resonance_is_critically_damped():
    """(5.28) says d_h <= 1: K_1 = 2 A_c sqrt(V_c/(beta m)) makes w_c = 2 w_h."""
    valve = linearise(PARAMETERS, 5e5, flow=0.0)
    assert corners(valve).d_h == pytest.approx(valve.restrictor_ratio, rel=1e-6)


@pytest.mark.parametrize("torque", [0.0, 2.0])
def test_closed_centre_simulation_agrees_with_the_sampled_linear_loop(torque):
    """R_T x over the wheel angle, up to 100 Hz, both controllers in the loop."""
    found = small_signal(PARAMETERS, "closed_centre", torque, amplitude=2e-6 / np.exp(torque))
    point = steering_study.small_signal_point(PARAMETERS, torque)
    manner = steering_study.data_sheet_manner(PARAMETERS)
    responses = closed_centre_assistance(point, manner, 2.0 * np.pi * found.frequency)
    ratio = found.rack_by_wheel / linear_gear(PARAMETERS).closed_loop(responses)
    assert np.max(np.abs(20.0 * np.log10(np.abs(ratio)))) < 0.3
    assert np.max(np.abs(np.degrees(np.angle(ratio)))) < 3.0


def test_loop_of_the_valve_at_its_highest_gain():
    """fig 6.6: phase margin near 85 degrees, far from any limit."""
    general = valve_study.loop_gain(PARAMETERS).margins()[0]
    simple = valve_study.loop_gain(PARAMETERS, general=False).margins()[0]
    assert simple.phase == pytest.approx(85.0, abs=1.0)
    assert general.phase == pytest.approx(81.8, abs=1.0)
    assert general.gain == pytest.approx(6.5, rel=0.05)


def test_holding_demand_is_the_plants_rest_force():
    plant = Plant(PARAMETERS, "closed_centre")
    p = plant.par[0]
    demand = holding_demand(PARAMETERS, linearise(PARAMETERS, 5e5, flow=0.0))
    force = demand * p["pressure_area"] + p["spring_preload"]
    assert force == pytest.approx(rest_solenoid_force(p, 5e5), rel=1e-9)


def test_static_characteristic_has_the_droop_as_its_slope():
    """fig 6.5 at a small flow: R_v of the valve with the flow force's share."""
    flow, step = 1e-5, 1e-7
    at = pressure_under_flow(PARAMETERS, 50e5, np.array([flow - step, flow, flow + step]))
    valve = linearise(PARAMETERS, float(at[1]), flow=flow)
    droop = 1.0 / (valve.K_c * (1.0 + valve.loop_gain))
    assert (at[0] - at[2]) / (2.0 * step) == pytest.approx(droop, rel=1e-3)


def test_large_and_small_step():
    """fig 6.7: 100 bar in 5 ms, overshoot below 5 bar; the small step misses the source's 6 ms."""
    large = valve_study.valve_step(PARAMETERS, 2e5, 100e5)
    assert large.first_reaches(0.9) == pytest.approx(5e-3, rel=0.1)
    assert large.overshoot < 5e5
    assert valve_study.valve_step(PARAMETERS, 5e5, 15e5).reaches(0.9) == pytest.approx(
        10e-3, rel=0.05
    )
    wide = PARAMETERS.with_values({"pressure_control_valve.underlap": 30e-6})
    assert valve_study.valve_step(wide, 5e5, 15e5).reaches(0.9) == pytest.approx(6.6e-3, rel=0.05)


def test_a_restrictor_beyond_its_criterion_ends_in_a_limit_cycle():
    """Linear onset at 5.3 times the criterion; the nonlinear valve is quiet at 4, cycles at 8."""
    within, quiet, cycling = valve_study.restrictor_validity(PARAMETERS, (0.92, 4.0, 8.0))
    assert within.damping > 0.3
    assert within.decibel < 1.5
    assert within.degrees < 2.0
    assert quiet.growth < 0.0 < cycling.growth
    assert quiet.ripple < 0.05e5
    assert cycling.ripple > 5e5


def test_linear_servo_valves_are_the_plants_slope():
    quiet = without_friction(PARAMETERS)
    plant = Plant(quiet, "servo_valve")
    model = numerical_model(plant, plant.state, plant.inputs)
    servo = linear_servo(quiet, float(plant.state[states.RIGHT]))
    omega = 2.0 * np.pi * np.array([1.0, 20.0, 200.0])
    pressure = (*states.SERVO_VALVE_NAMES[states.RIGHT_SERVO :], "right_pressure")
    alone = model.selected(pressure, ("right_solenoid",), ("right_pressure",))
    by_command = alone.response(omega)[:, 0, 0]
    np.testing.assert_allclose(servo.responses(1j * omega)[0], by_command, rtol=1e-4)
    # (7.10): with the chamber matched an integrator K_p0/s is left behind the spools and the lead
    loop = by_command * servo_controller(quiet, servo, 1j * omega, sampled=False)
    gain = quiet["servo_valve.controller_gain"]
    assert abs(loop[0]) == pytest.approx(gain / omega[0], rel=0.01)
