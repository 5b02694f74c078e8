"""The controller as an object: rest, mirror, limits, anti-windup, its loop with a linear valve."""

import copy
import dataclasses

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from pressure_control.compensator import compensator_gains
from pressure_control.controller import CONTROLLERS, ValveController
from pressure_control.linear_valve import linearise, simplified_response
from pressure_control.schedule import scheduled_poles
from pressure_control.state_places import INTEGRAL
from steering_core.parameters import load_parameters
from steering_plant.boost_curve import boost_pressure
from steering_plant.measured_boost_curve import boost_table, read_boost_curve
from steering_plant.plant import Plant

PARAMETERS = load_parameters()
SUPPLY = PARAMETERS["closed_centre.supply_pressure"]
STRONGEST = PARAMETERS["pressure_control_valve.maximum_solenoid_force"]

finite = st.floats(allow_nan=False, allow_infinity=False)
sensible = st.floats(-10.0, 10.0)
pressures = st.floats(0.0, 2e7)


TEMPLATES = {side: ValveController(PARAMETERS, side) for side in ("left", "right")}


def fresh(side):
    """A controller at rest; a copy spares the stability check of a new one."""
    return copy.deepcopy(TEMPLATES[side])


def measured(torque=0.0, right=4.9e5, left=4.9e5, speed=0.0, rack_v=0.0, rack_x=0.0, supply=SUPPLY):
    """Inputs of ``step`` after the tick."""
    return (0.0, speed, torque, left, right, supply, rack_x, rack_v, 0.0)


def test_registry_makes_the_controllers():
    for kind in CONTROLLERS.values():
        assert kind(PARAMETERS, "left", None).out.shape == (2,)


def test_a_side_must_be_left_or_right():
    with pytest.raises(ValueError, match="'top'"):
        ValveController(PARAMETERS, "top")  # type: ignore[arg-type]


@pytest.mark.parametrize("side", ["left", "right"])
@pytest.mark.parametrize("raised", [0.0, 5e6])
def test_nothing_moves_at_rest(side, raised):
    parameters = PARAMETERS.with_values({"valve_controller.common_pressure_raise": raised})
    controller, plant = ValveController(parameters, side), Plant(parameters, "closed_centre")
    at_first = controller.out.copy()
    for tick in range(5):
        controller.step(tick, *plant.out)
        np.testing.assert_allclose(controller.out, at_first, rtol=1e-10)


def test_plant_and_controllers_start_in_one_equilibrium():
    plant = Plant(PARAMETERS, "closed_centre")
    sides = [fresh(side) for side in ("left", "right")]
    at_first = plant.out[3:5].copy()
    for tick in range(200):
        left, right = (side.step(tick, *plant.out)[1] for side in sides)
        plant.step(tick, 0.0, left, right, 0.0, 0.0, 0.0)
        assert np.max(np.abs(plant.out[3:5] - at_first)) < 1.0


@given(
    st.lists(
        st.tuples(sensible, sensible, sensible, pressures, pressures, pressures, sensible, sensible)
    )
)
@settings(max_examples=30, deadline=None)
def test_left_is_the_mirror_image_of_right_to_the_bit(rows):
    right, left = fresh("right"), fresh("left")
    for tick, (angle, speed, torque, one, other, supply, rack_x, rack_v) in enumerate(rows):
        a = right.step(tick, angle, speed, torque, one, other, supply, rack_x, rack_v, 7.0)
        b = left.step(tick, -angle, -speed, -torque, other, one, supply, -rack_x, -rack_v, -7.0)
        assert a.tobytes() == b.tobytes()
    assert right.state.tobytes() == left.state.tobytes() or np.array_equal(right.state, left.state)


@given(st.lists(st.tuples(*[finite] * 9), max_size=8))
@settings(max_examples=60, deadline=None)
def test_finite_inputs_give_outputs_within_the_limits(rows):
    for side in ("left", "right"):
        controller = fresh(side)
        for tick, row in enumerate(rows):
            reference, force = controller.step(tick, *row)
            assert 0.0 <= force <= STRONGEST
            assert 0.0 <= reference <= 2.0 * SUPPLY
            assert np.all(np.isfinite(controller.state))


@pytest.mark.parametrize("torque", [-3.0, -0.8, 0.0, 1.4])
def test_a_measured_boost_curve_takes_the_formulas_place(tmp_path, torque):
    """An uneven curve: each side follows its own half of it."""
    path = tmp_path / "curve.csv"
    path.write_text(
        "torsion_bar_torque_Nm,load_pressure_Pa\n-4,-9e6\n-2,-8e5\n0,0\n2,1.2e6\n4,7e6\n"
    )
    table = boost_table(read_boost_curve(path))
    sides = {side: ValveController(PARAMETERS, side, table) for side in ("left", "right")}
    found = {side: core.step(0, *measured(torque=torque))[0] for side, core in sides.items()}
    curve = boost_pressure(sides["right"].par[0], table, torque)
    assert found["right"] - found["left"] == pytest.approx(curve, rel=1e-9, abs=1e-2)


def test_one_tick_is_the_compensators_difference_equation():
    """Written out again from (6.6) for a single error step, at the rest point."""
    controller = fresh("right")
    before = controller.out[1]
    pressure = controller.out[0] - 1e4
    after = controller.step(0, *measured(right=pressure, left=pressure))[1]
    p = controller.par[0]
    # the loop sees 1e4 Pa more than it has: D, the integrator's and the low-pass's first share
    rise = (after - before) / p["pressure_area"] / 1e4
    a = 2 * p["damping"] * p["resonance"]
    w_0, d_0, static_gain = scheduled_poles(p, pressure, SUPPLY, 0.0, 0.0, 0.0, 0.0)
    direct = (p["resonance"] / w_0) ** 2
    f = -((p["resonance"] / a) ** 2) * ((a / w_0) ** 2 - 2 * d_0 * a / w_0 + 1)
    expected = direct + p["resonance"] ** 2 / a * 1e-3 + f * (1 - np.exp(-a * 1e-3))
    assert rise == pytest.approx(expected / static_gain, rel=1e-6)


def test_saturation_is_left_at_once():
    """At the force's limit for a second, and back: the integrator has not run away."""
    controller = fresh("right")
    for tick in range(1000):
        force = controller.step(tick, *measured(torque=6.0, right=0.0))[1]
    assert force == pytest.approx(STRONGEST, rel=1e-12)
    held = controller.state[INTEGRAL]
    p = controller.par[0]
    assert held <= (STRONGEST - p["spring_preload"]) / p["pressure_area"]
    # now the chamber is above its reference: the force leaves the limit within a tick or two
    forces = [controller.step(k, *measured(torque=0.0, right=6e6))[1] for k in range(10)]
    assert forces[0] < STRONGEST
    assert forces[-1] < 0.5 * STRONGEST


def test_a_weak_solenoid_starts_at_its_limit():
    weak = PARAMETERS.with_values({"pressure_control_valve.maximum_solenoid_force": 10.0})
    controller = ValveController(weak, "left")
    assert controller.out[1] == 10.0
    assert controller.step(0, *measured())[1] <= 10.0


def test_integrator_never_exceeds_what_the_solenoid_can_hold():
    controller = fresh("right")
    p = controller.par[0]
    rng = np.random.default_rng(3)
    for tick in range(3000):
        torque, right, left = rng.uniform(-6, 6), *rng.uniform(0, 2e7, 2)
        controller.step(tick, *measured(torque=torque, right=right, left=left))
        demand = controller.state[INTEGRAL] * p["pressure_area"] + p["spring_preload"]
        assert -1e-9 <= demand <= STRONGEST + 1e-9


@pytest.mark.parametrize("pressure", [1.5e6, 4e6, 8e6])
@pytest.mark.parametrize("displacement", [2e-5, -2e-5, 1e-4])
def test_loop_is_the_double_integral_form_of_the_source(pressure, displacement):
    """G of the valve equals w_k^2/(s (s + k w_k^2)) below the sampling's reach, for any K_s."""
    w_k, d_k, period = 300.0, 1.2, 1e-3
    valve = linearise(PARAMETERS, pressure, displacement=displacement)
    gains = compensator_gains(w_k, d_k, valve.w_0, valve.d_0, valve.K_s)
    direct, filtered, integral_weight, error_weight = gains
    omega = np.array([10.0, 30.0, 100.0, 200.0])
    z = np.exp(1j * omega * period)
    compensator = direct + integral_weight * z / (z - 1)
    compensator = compensator + filtered * error_weight * z / (z - 1 + error_weight)
    hold = (1 - 1 / z) / (1j * omega * period)
    s = 1j * omega
    expected = w_k**2 / (s * (s + 2 * d_k * w_k))
    ratio = compensator * hold * simplified_response(valve, omega) / expected
    np.testing.assert_allclose(np.abs(ratio), 1.0, atol=0.05)
    # the states' lead and the hold's lag cancel: no more than a third of a sample is left
    assert np.all(np.abs(np.angle(ratio)) < omega * period / 3)


def test_loop_has_the_phase_margin_of_its_form():
    """w_k^2/(s (s + a)) with damping 1.2 has 80 degrees."""
    valve = linearise(PARAMETERS, 4e6)
    unit = dataclasses.replace(valve, K_p=0.0)
    w_k, d_k = 300.0, 1.2
    direct, filtered, integral_weight, error_weight = compensator_gains(
        w_k, d_k, unit.w_0, unit.d_0, unit.K_s
    )
    omega = np.linspace(20, 600, 4000)
    z = np.exp(1j * omega * 1e-3)
    loop = (
        direct
        + integral_weight * z / (z - 1)
        + filtered * error_weight * z / (z - 1 + error_weight)
    )
    loop = loop * simplified_response(unit, omega) * (1 - 1 / z) / (1j * omega * 1e-3)
    crossing = np.argmax(np.abs(loop) < 1.0)
    margin = 180.0 + np.degrees(np.angle(loop[crossing]))
    a = 2 * d_k * w_k
    cross = np.sqrt((np.sqrt(a**4 + 4 * w_k**4) - a**2) / 2)
    assert omega[crossing] == pytest.approx(cross, rel=0.05)
    assert margin == pytest.approx(180 - 90 - np.degrees(np.arctan(cross / a)), abs=3.0)
