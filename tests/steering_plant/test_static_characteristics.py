"""Boost curve, opening areas, bridge equations and the state of rest."""

import math

import numpy as np
import pytest
from fine_steps import CLAMP

from steering_core.parameters import load_parameters
from steering_plant.boost_curve import (
    FORMULA,
    boost_pressure,
    boost_record,
    opening_areas,
    static_pressures,
)
from steering_plant.model.dynamics import rates
from steering_plant.plant import Plant
from steering_plant.rest import rest_solenoid_force

PARAMETERS = load_parameters()
CURVE = boost_record(PARAMETERS)[0]
BAR, LITRE_PER_MINUTE = 1e5, 1e-3 / 60.0


@pytest.mark.parametrize(("torque", "bar"), [(1, 3.4), (2, 11.9), (3, 33.5), (4, 89.5)])
def test_boost_curve(torque, bar):
    assert boost_pressure(CURVE, FORMULA, torque) == pytest.approx(bar * BAR, rel=0.025)
    assert boost_pressure(CURVE, FORMULA, -torque) == -boost_pressure(CURVE, FORMULA, torque)


def test_opening_areas():
    """Fig 3.5: 0.59, 2.60 and 3.35 mm2 at -4, 0 and 4 N m."""
    found = [opening_areas(CURVE, FORMULA, torque)[0] for torque in (-4.0, 0.0, 4.0)]
    assert found == pytest.approx([0.59e-6, 2.60e-6, 3.35e-6], rel=0.01)
    steps = np.diff([opening_areas(CURVE, FORMULA, t)[0] for t in np.linspace(-6.0, 6.0, 601)])
    assert np.all(steps > 0.0)
    # smooth through zero torque: the slopes on both sides agree
    assert steps[299] == pytest.approx(steps[300], rel=0.02)


@pytest.mark.parametrize("litres", [-5.0, -2.0, 0.0, 2.0, 5.0])
@pytest.mark.parametrize("torque", [-4.0, -1.0, 0.0, 2.5])
def test_the_static_map_fulfils_the_bridges_equations(torque, litres):
    """(4.3) and (4.4) with the map's own pressures give back pump and load flow."""
    flow = litres * LITRE_PER_MINUTE
    right, left = static_pressures(CURVE, FORMULA, torque, flow)
    a1, a2 = opening_areas(CURVE, FORMULA, torque)
    pump, load = right + left, right - left
    k = PARAMETERS["oil.flow_coefficient"] / math.sqrt(PARAMETERS["oil.density"])
    through_1, through_2 = k * a1 * math.sqrt(pump - load), k * a2 * math.sqrt(pump + load)
    assert through_1 + through_2 == pytest.approx(PARAMETERS["open_centre.pump_flow"], rel=1e-12)
    assert through_1 - through_2 == pytest.approx(flow, abs=1e-17)


def test_static_characteristic_of_fig_4_3():
    loads = []
    for litres in (-5.0, 0.0, 5.0):
        right, left = static_pressures(CURVE, FORMULA, 4.0, litres * LITRE_PER_MINUTE)
        loads.append((right - left) / BAR)
    assert loads == pytest.approx([276.0, 91.0, -1.0], abs=2.0)


@pytest.mark.parametrize("torque", [0.5, 1.0, 2.0, 3.0, 3.9])
def test_a_clamped_rack_settles_on_the_boost_curve(torque):
    """The plant itself, driven to rest: load pressure at the torque it then shows."""
    damped = PARAMETERS.with_values({"mechanics.steering_wheel_damping": 2.0})
    plant = Plant(damped, "open_centre")
    for tick in range(3000):
        plant.step(tick, torque, 0.0, 0.0, 0.0, CLAMP, 0.0)
    felt, left, right = plant.out[2], plant.out[3], plant.out[4]
    expected = boost_pressure(CURVE, FORMULA, felt)
    assert right - left == pytest.approx(expected, rel=2e-3, abs=0.01 * BAR)


@pytest.mark.parametrize("system", ["open_centre", "closed_centre"])
def test_rest_is_an_equilibrium(system):
    plant = Plant(PARAMETERS, system)
    held = np.zeros(6)
    if system == "closed_centre":
        held[1:3] = rest_solenoid_force(plant.par[0], plant.state[6])
    slopes, flows = np.zeros(len(plant.state)), np.zeros(3)
    rates(plant.par[0], plant.table, plant.effects, 0.0, plant.state, held, slopes, flows)
    slopes[8] = 0.0
    assert np.abs(slopes[6:8]).max() < 1.0 * BAR * 1e-3
    before = plant.state.copy()
    for tick in range(500):
        plant.step(tick, *held)
    drift = np.abs(plant.state - before)
    drift[8] = 0.0
    assert drift[:4].max() < 1e-9
    assert drift[6:8].max() < 1e-4 * BAR


def test_rest_pressures():
    """About 9.8 bar at the pump and 4.9 bar in the chambers."""
    plant = Plant(PARAMETERS, "open_centre")
    assert plant.out[3:6] / BAR == pytest.approx([4.9, 4.9, 9.75], abs=0.05)
    assert Plant(PARAMETERS, "closed_centre").out[3] == pytest.approx(plant.out[3], rel=0.01)
