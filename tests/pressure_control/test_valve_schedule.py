"""Schedule and feed-forward: continuity, and agreement with the valve they stand for."""

import math

import numpy as np
import pytest

from pressure_control.linear_valve import linearise
from pressure_control.record import controller_record
from pressure_control.schedule import (
    flow_feed_forward,
    opening_for_flow,
    scheduled_poles,
    uncovered_depth,
)
from pressure_control.valve_gains import displacement_for_flow
from steering_core.parameters import load_parameters
from steering_plant.control_valve import holes_area

PARAMETERS = load_parameters()
P = controller_record(PARAMETERS, "right")[0]
SUPPLY = PARAMETERS["closed_centre.supply_pressure"]


def poles(pressure, flow, rack_position=0.0, p=P):
    area, depth, _ = opening_for_flow(p, pressure, SUPPLY, flow)
    return np.array(scheduled_poles(p, pressure, SUPPLY, flow, area, depth, rack_position))


def feed_forward(pressure, flow, p=P):
    return flow_feed_forward(p, flow, *opening_for_flow(p, pressure, SUPPLY, flow))


@pytest.mark.parametrize("pressure", [5e5, 1.5e6, 8e6])
@pytest.mark.parametrize("flow", [-3e-5, -1e-5, 8e-6, 4e-5])
def test_schedule_meets_the_linearised_valve_where_flow_places_the_spool(pressure, flow):
    valve = linearise(PARAMETERS, pressure, flow=flow)
    assert abs(valve.displacement) > PARAMETERS["valve_controller.nominal_spool_displacement"]
    np.testing.assert_allclose(poles(pressure, flow), (valve.w_0, valve.d_0, valve.K_s), rtol=0.02)


def test_schedule_without_flow_is_between_both_edges():
    found = poles(1.5e6, 0.0)
    nominal = PARAMETERS["valve_controller.nominal_spool_displacement"]
    supply_edge = linearise(PARAMETERS, 1.5e6, displacement=nominal)
    tank_edge = linearise(PARAMETERS, 1.5e6, displacement=-nominal)
    assert tank_edge.w_0 < found[0] < supply_edge.w_0


def test_schedule_is_continuous():
    """A hundredth of the blend moves resonance and damping by less than 3 %."""
    for pressure in (1e5, 5e5, 4e6, 1.9e7):
        rows = np.array([poles(pressure, q) for q in np.arange(-4e-5, 4e-5, 5e-8)])
        assert np.all(np.isfinite(rows))
        assert np.max(np.abs(np.diff(np.log(rows), axis=0))) < 0.03
    rows = np.array([poles(p, -1e-5) for p in np.arange(1e5, 1.99e7, 5e3)])
    assert np.max(np.abs(np.diff(np.log(rows), axis=0))) < 0.03


def test_chamber_volume_follows_the_rack():
    centre, end = poles(1.5e6, 2e-5), poles(1.5e6, 2e-5, -0.05)
    volume = PARAMETERS["open_centre.chamber_volume"]
    swept = PARAMETERS["mechanics.piston_area"] * 0.05
    assert end[0] / centre[0] == pytest.approx(math.sqrt(volume / (volume - swept)), rel=1e-9)
    assert np.all(np.isfinite(poles(1.5e6, 2e-5, -1e300)))


@pytest.mark.parametrize("pressure", [5e5, 1.5e6, 8e6])
@pytest.mark.parametrize("flow", [-4e-5, -1e-5, -2e-6, 2e-6, 1e-5, 4e-5])
def test_feed_forward_is_the_spools_static_balance(pressure, flow):
    """Second route: displacement by root finding on the exact area, then forces."""
    x = displacement_for_flow(PARAMETERS, pressure, flow)
    valve = linearise(PARAMETERS, pressure, displacement=x)
    drop = SUPPLY - pressure if flow > 0.0 else -pressure
    area = holes_area(P["hole_diameter"], P["underlap"] + abs(x))
    force = P["spring_stiffness"] * x + P["jet_factor"] * area * drop
    assert feed_forward(pressure, flow) == pytest.approx(force / valve.A_c, rel=0.02)


@pytest.mark.parametrize(("pressure", "flow"), [(1.5e6, 2e-5), (5e5, -3e-5)])
def test_feed_forwards_slope_is_the_printed_gain(pressure, flow):
    """(6.9): K_e/(A_c K_q) for small changes of flow."""
    step = 1e-8
    slope = (feed_forward(pressure, flow + step) - feed_forward(pressure, flow - step)) / (2 * step)
    assert slope == pytest.approx(linearise(PARAMETERS, pressure, flow=flow).R_v, rel=0.02)


def test_printed_gain_times_the_whole_flow_falls_short():
    """The area grows with depth^1.5: at the tank edge, spring alone, by nearly a third."""
    pressure, flow = 5e5, -3e-5
    printed = linearise(PARAMETERS, pressure, flow=flow).R_v * flow
    assert 1.35 < feed_forward(pressure, flow) / printed < 1.5


def test_feed_forward_is_continuous_and_odd_in_sign_with_underlap_and_with_overlap():
    for underlap in (5e-6, 0.0, -1e-5):
        changed = PARAMETERS.with_values({"pressure_control_valve.underlap": underlap})
        p = controller_record(changed, "right")[0]
        flows = np.arange(-2e-5, 2e-5, 2e-8)
        values = np.array([feed_forward(1.5e6, q, p) for q in flows])
        assert np.max(np.abs(np.diff(values))) < 0.3e5
        assert np.all(values * np.sign(np.round(flows, 12)) >= 0.0)


def test_depth_series_inverts_the_holes_area():
    diameter = P["hole_diameter"]
    for depth in np.linspace(1e-6, diameter / 3, 40):
        found = uncovered_depth(P, holes_area(diameter, depth))
        assert found == pytest.approx(depth, rel=0.016)
