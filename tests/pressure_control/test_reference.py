"""Reference pressures against the open-centre valve's closed form, and the mirrored table."""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.optimize import brentq

from pressure_control.record import controller_record
from pressure_control.reference import compensation_speed, mirrored, reference_pressures
from steering_core.parameters import load_parameters
from steering_plant.boost_curve import FORMULA, boost_pressure, opening_areas
from steering_plant.measured_boost_curve import boost_table, read_boost_curve

PARAMETERS = load_parameters()
P = controller_record(PARAMETERS, "right")[0]
SUPPLY = PARAMETERS["closed_centre.supply_pressure"]

CURVE = [(-6.0, -1.2e7), (-2.0, -1.0e6), (-0.5, -1.0e5), (0.3, 9e4), (1.9, 1.3e6), (5.0, 1.1e7)]


@pytest.fixture
def table(tmp_path):
    path = tmp_path / "curve.csv"
    rows = "\n".join(f"{torque},{pressure}" for torque, pressure in CURVE)
    path.write_text(f"torsion_bar_torque_Nm,load_pressure_Pa\n{rows}\n")
    return boost_table(read_boost_curve(path))


@pytest.mark.parametrize("torque", [-4.0, -1.3, 0.0, 0.7, 2.0, 3.1, 4.0])
def test_without_flow_the_difference_is_the_boost_curve(torque):
    """fig 3.4: 3.4, 11.9, 33.5 and 89.5 bar at 1, 2, 3 and 4 N m."""
    right, load = reference_pressures(P, FORMULA, torque, 0.0, SUPPLY)
    left, _ = reference_pressures(P, FORMULA, -torque, 0.0, SUPPLY)
    boost = 2.17e5 * math.expm1(0.94 * abs(torque)) * np.sign(torque)
    assert load == pytest.approx(boost, rel=1e-9, abs=1e-3)
    assert right - left == pytest.approx(boost, rel=1e-9, abs=1e-3)


@pytest.mark.parametrize("torque", [-3.0, -0.4, 0.0, 1.0, 2.5])
@pytest.mark.parametrize("flow", [-5e-5, -1e-5, 2e-5, 6e-5])
def test_reference_solves_the_bridges_orifice_equations(torque, flow):
    """Second route: solve the node equations of the four orifices for each chamber's pressure."""
    wide, narrow = opening_areas(P, FORMULA, torque)
    pump, density, coefficient = P["pump_flow"], P["density"], P["flow_coefficient"]

    def passed(area, drop):
        return coefficient * area * math.copysign(math.sqrt(2 * abs(drop) / density), drop)

    def chambers(pump_pressure):
        right = brentq(
            lambda p: passed(wide, pump_pressure - p) - passed(narrow, p) - flow, -1e9, 1e9
        )
        left = brentq(
            lambda p: passed(narrow, pump_pressure - p) - passed(wide, p) + flow, -1e9, 1e9
        )
        return right, left

    def surplus(pump_pressure):
        right, left = chambers(pump_pressure)
        return passed(wide, pump_pressure - right) + passed(narrow, pump_pressure - left) - pump

    expected, _ = chambers(brentq(surplus, 0.0, 1e9, xtol=1e-3))
    found, _ = reference_pressures(P, FORMULA, torque, flow, 1e9)
    assert found == pytest.approx(max(expected, 0.0), rel=1e-6)


def test_common_raise_is_added_to_both_and_leaves_the_load_pressure():
    raised = PARAMETERS.with_values({"valve_controller.common_pressure_raise": 5e6})
    p = controller_record(raised, "right")[0]
    for torque in (-1.0, 0.0, 2.0):
        high, high_load = reference_pressures(p, FORMULA, torque, 1e-5, SUPPLY)
        low, low_load = reference_pressures(P, FORMULA, torque, 1e-5, SUPPLY)
        assert high == pytest.approx(low + 5e6, rel=1e-12)
        assert high_load == low_load


@given(
    torque=st.floats(-1e308, 1e308),
    flow=st.floats(-1e308, 1e308),
    supply=st.floats(0.0, 1e308),
)
def test_reference_stays_between_zero_and_supply_less_margin(torque, flow, supply):
    reference, load = reference_pressures(P, FORMULA, torque, flow, supply)
    assert 0.0 <= reference <= max(supply - P["reference_supply_margin"], 0.0)
    assert math.isfinite(load)


def test_compensation_speed_is_the_wheels_at_once_and_the_racks_in_the_end():
    speed, slip = compensation_speed(P, 0.0, 0.05, 0.05)
    assert (speed, slip) == (0.05, 0.0)
    speeds = []
    for _ in range(50):
        speed, slip = compensation_speed(P, slip, 0.05, 0.02)
        speeds.append(speed)
    # exact for a held input
    lowpass = PARAMETERS["valve_controller.velocity_lowpass"]
    expected = 0.02 + 0.03 * np.exp(-1e-3 * np.arange(1, 51) / lowpass)
    np.testing.assert_allclose(speeds, expected, rtol=1e-12)


def test_mirrored_table_is_the_curve_turned_about_the_origin(table):
    image = mirrored(table)
    for torque in np.linspace(-9.0, 9.0, 361):
        assert boost_pressure(P, image, -torque) == pytest.approx(
            -boost_pressure(P, table, torque), rel=1e-9, abs=1e-4
        )
    np.testing.assert_allclose(mirrored(image)[1:], table[1:], rtol=1e-9, atol=1e-6)
    assert mirrored(FORMULA) is FORMULA
