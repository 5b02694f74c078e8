"""Rig tests made with known parameters give them back, inside their intervals and within 3 %."""

from functools import partial

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from steering_bringup.errors import BenchError
from steering_core.parameters import load_parameters
from steering_studies.identification.column import inertia, stiffness
from steering_studies.identification.estimate import Estimate, fit
from steering_studies.identification.friction_element import friction_share
from steering_studies.identification.identify import identify
from steering_studies.identification.opening_areas import boost_points, opening_areas
from steering_studies.identification.rack_friction import loop_friction
from steering_studies.identification.write import write_curve, write_set
from steering_studies.rig_tests.simulate import TYPICAL_NOISE, simulate
from steering_studies.rig_tests.tests import FRICTION_PRESSURES_BAR, RIG_TESTS

NOMINAL = load_parameters()
CHANGED = {
    "mechanics.rack_friction": 1.08,
    "mechanics.rack_friction_pressure_slope": 0.93,
    "mechanics.column_friction": 0.91,
    "mechanics.torsion_bar_stiffness": 1.06,
    "mechanics.steering_wheel_inertia": 0.94,
    "mechanics.steering_wheel_damping": 1.09,
    "open_centre.boost_scale": 0.92,
    "open_centre.boost_rate": 1.02,
    "open_centre.centre_opening": 1.05,
}
"""Factors on the nominal values."""


def gear(seed: int) -> dict[str, float]:
    values = {name: factor * NOMINAL[name] for name, factor in CHANGED.items()}
    return {**values, **TYPICAL_NOISE, "simulation.noise_seed": float(seed)}


@pytest.fixture(scope="module")
def runs():
    tests = [name for name in RIG_TESTS if name != "system"]
    return {run: c for test in tests for run, c in simulate(test, gear(7)).items()}


@pytest.fixture(scope="module")
def found(runs):
    return identify(runs)


@pytest.mark.parametrize("name", CHANGED)
def test_every_parameter_comes_back(found, name):
    estimate, truth = found.estimates[name], CHANGED[name] * NOMINAL[name]
    assert estimate.low < truth < estimate.high
    assert estimate.value == pytest.approx(truth, rel=0.03)
    assert estimate.high - estimate.low < 0.1 * truth


def test_the_areas_are_those_of_the_valve_on_both_sides(runs):
    """Second route: the plant's own areas, which the estimator has never seen."""
    from steering_plant.boost_curve import opening_areas as of_the_plant
    from steering_plant.plant import Plant

    plant = Plant(NOMINAL.with_values(gear(7)), "open_centre")
    curve = opening_areas(runs["boost_curve"], NOMINAL)
    true = np.array([of_the_plant(plant.par[0], plant.table, t) for t in curve.torque])
    inner = np.abs(curve.torque) < 3.2
    np.testing.assert_allclose(curve.area_1[inner], true[inner, 0], rtol=0.02)
    np.testing.assert_allclose(curve.area_2[inner], true[inner, 1], rtol=0.02)


def test_loops_grow_linearly_with_the_pressure():
    """Prototype figures of the data sheet: 82, 104, 148, 236, 324, 412 N (fig 3.6)."""
    runs = simulate("rack_friction")
    heights = [loop_friction(channels, NOMINAL) for channels in runs.values()]
    wanted = [60.0 + 2.2e-5 * 2.0 * max(bar, 4.9) * 1e5 for bar in FRICTION_PRESSURES_BAR]
    np.testing.assert_allclose(heights, wanted, rtol=0.01)


def test_stiffness_and_frequency_are_the_source_s():
    clamped = simulate("stiffness")["stiffness"]
    found = stiffness(clamped, NOMINAL)["mechanics.torsion_bar_stiffness"]
    assert np.radians(found.value) == pytest.approx(1.06, rel=0.01)
    free = simulate("inertia", {"mechanics.column_friction": 1e-6})["inertia"]
    assert first_frequency(free) == pytest.approx(5.15, rel=0.003)
    # The column's friction element is a spring as well: it makes a small swing faster.
    assert first_frequency(simulate("inertia")["inertia"]) == pytest.approx(5.15, rel=0.02)


def first_frequency(channels) -> float:
    swing = channels["torsion_bar_torque"][1010:]
    crossings = np.flatnonzero(np.diff(np.sign(swing)) != 0)[:4]
    return float(500.0 / np.mean(np.diff(crossings)))


def test_a_set_and_a_curve_load_again(found, runs, tmp_path):
    path = tmp_path / "mine.yaml"
    mine = write_set(found, path)
    for name, estimate in found.estimates.items():
        assert mine[name] == pytest.approx(estimate.value, rel=1e-5)
        assert 0.0 < mine.info(name).tolerance < 0.2
    from steering_plant.measured_boost_curve import boost_table, read_boost_curve

    write_curve(found.boost_curve, tmp_path / "curve.csv")
    boost_table(read_boost_curve(str(tmp_path / "curve.csv")))
    _, pressure = boost_points(found.boost_curve)
    assert np.all(np.diff(pressure) >= 0.0)


def test_what_was_not_tested_is_said():
    found = identify({"stiffness": simulate("stiffness")["stiffness"]})
    assert set(found.missing) == {"boost_curve", "rack_friction", "column_friction", "inertia"}
    with pytest.raises(BenchError, match="none of these runs is a rig test"):
        identify({"holiday": {}})


def test_a_wheel_that_hardly_moves_gives_no_stiffness():
    still = {"steering_wheel_angle": np.zeros(3000), "torsion_bar_torque": np.zeros(3000)}
    with pytest.raises(BenchError, match="less than 1 deg"):
        stiffness(still, NOMINAL)
    known = {
        name: Estimate(NOMINAL[name], 0.0, 1.0, "")
        for name in ("mechanics.column_friction", "mechanics.column_friction_angle")
    }
    with pytest.raises(BenchError, match="no release"):
        inertia(still, NOMINAL, known)


@given(st.lists(st.floats(-1e-2, 1e-2), min_size=2, max_size=40), st.floats(1e-5, 1e-2))
def test_the_friction_element_never_gives_energy_back(steps, displacement):
    """Stored energy of an exponential spring is at most limit x displacement."""
    position = np.concatenate([[0.0], np.cumsum(np.repeat(np.array(steps) / 50.0, 50))])
    share = friction_share(position, displacement)
    assert np.all(np.abs(share) <= 1.0)
    work = np.sum(0.5 * (share[1:] + share[:-1]) * np.diff(position))
    assert work >= -1e-9 - 0.01 * np.sum(np.abs(np.diff(position)))


def test_intervals_cover_where_neighbouring_errors_are_alike():
    random = np.random.default_rng(5)
    x = np.sin(0.01 * np.arange(4000))
    inside = 0
    for _ in range(60):
        noise = np.convolve(random.normal(size=4100), np.ones(60) / 60.0, "same")[:4000]
        y = 2.0 * x + noise
        (found,) = fit(partial(_line_error, x, y), (1.0,), ("1",), lags=200, source="test")
        inside += found.low < 2.0 < found.high
    assert inside >= 51


def _line_error(x, y, p):
    return y - p[0] * x
