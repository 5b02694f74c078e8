"""What fewer channels show: the truth's answer, and the runs behind it."""

from dataclasses import replace

import numpy as np
import pytest

from steering_core.parameters import load_parameters
from steering_diagnosis.benchmark.doors.door import Door
from steering_diagnosis.benchmark.doors.logger import Logger
from steering_diagnosis.benchmark.truth import states as s
from steering_diagnosis.benchmark.truth.course import draw_course
from steering_diagnosis.benchmark.truth.effects import TRUE_EFFECTS, changed
from steering_diagnosis.benchmark.truth.run import run_clamped, run_closed_loop
from steering_diagnosis.benchmark.truth.specimen import draw_specimen
from steering_diagnosis.benchmark.view import View, seen_as, through, told
from steering_diagnosis.benchmark.visibility import Probe, Sensitivity

SYSTEM = "closed_centre"
NOMINAL = load_parameters()
SIZES = {"column_friction": 6.0, "external_leakage_left": 4e-12, "rack_mass": 60.0}
BAG = Door("bag")


@pytest.fixture(scope="module")
def record():
    random = np.random.default_rng(5)
    course = draw_course(random, 2.0, "weave", "bicycle")
    specimen = draw_specimen(NOMINAL, random)
    return specimen, course, run_closed_loop(specimen, NOMINAL, course, closed=True)


@pytest.fixture(scope="module")
def view(record):
    specimen, course, given = record
    probe = Probe(specimen, NOMINAL, SYSTEM, course, given)
    hidden = {name: TRUE_EFFECTS[SYSTEM][name] for name in SIZES}
    sheet = {**specimen.sheet, "mechanics.gear_ratio": 1.002 * NOMINAL["mechanics.gear_ratio"]}
    tolerance = probe.difference(replace(specimen, sheet=sheet))
    effects = {name: probe.effect(effect, effect.typical) for name, effect in hidden.items()}
    sizes = {name: effect.typical for name, effect in hidden.items()}
    seen = Sensitivity(effects, sizes, tolerance[:, None])
    return View("pair", probe, seen, seen_as("pair", probe, seen, SIZES), hidden, hidden, SIZES)


def ratios(view, record, *lacking, **more):
    return told(through(view, Door("bag", lacking, **more), record[2]))


def test_all_channels_show_all(view, record):
    assert ratios(view, record)["unseen"] == []
    assert ratios(view, record)["ratios"] == pytest.approx(told(view)["ratios"])


def test_the_drivers_torque_alone_shows_the_columns_friction(view, record):
    without = ratios(view, record, "driver_torque")
    assert without["ratios"]["column_friction"] == pytest.approx(0.0, abs=1e-6)
    assert without["unseen"] == ["column_friction"]
    assert without["mistaken"]["column_friction"] == []


def test_without_the_valves_commands_nobody_sees_a_leak(view, record):
    without = ratios(view, record, "valve_commands")
    assert without["ratios"]["external_leakage_left"] == pytest.approx(0.0, abs=1e-6)
    assert "external_leakage_left" in without["unseen"]
    assert without["ratios"]["rack_mass"] > 0.0


def test_less_is_seen_with_less(view, record):
    whole = told(view)["ratios"]
    for group in ("load_command", "speeds", "driver_torque", "left_pressure"):
        less = ratios(view, record, group)["ratios"]
        assert all(less[name] <= whole[name] * (1.0 + 1e-9) for name in SIZES), group
    few = ratios(view, record, logger=Logger(digits=3))["ratios"]
    assert all(few[name] < whole[name] for name in SIZES)


def test_along_its_own_pressures_a_gear_does_what_it_did(record):
    """The second route: prescribed pressures and valves that make them move the rack alike."""
    specimen, course, given = record
    free = run_clamped(specimen, NOMINAL, course, given, closed=True)
    pressed = run_clamped(specimen, NOMINAL, course, given, closed=True, pressed=True)
    span = np.ptp(given.true, axis=0)
    for row in (s.TORQUE_OUT, s.LEFT_OUT, s.RIGHT_OUT, s.RACK_OUT):
        assert np.abs(pressed.true[:, row] - given.true[:, row]).max() < 0.02 * span[row]
        assert np.abs(pressed.true[:, row] - free.true[:, row]).max() < 0.02 * span[row]


def test_sensors_of_prescribed_pressures_act_inversely(record):
    """What reads too much must have felt less, cross-talk included."""
    specimen, course, given = record
    probe = Probe(specimen, NOMINAL, SYSTEM, course, given, pressed=True)
    other = changed(
        specimen,
        NOMINAL,
        SYSTEM,
        {"pressure_sensor_offset_right": 2e5, "pressure_crosstalk": 0.1},
    )
    felt = probe._felt(other).true

    def read(by, true):
        right = by.sensors[s.RIGHT_OUT, 0] * true[:, s.RIGHT_OUT] + by.sensors[s.RIGHT_OUT, 1]
        left = true[:, s.LEFT_OUT] + by.extras["crosstalk"] * true[:, s.RIGHT_OUT]
        return by.sensors[s.LEFT_OUT, 0] * left + by.sensors[s.LEFT_OUT, 1], right

    for one, two in zip(read(specimen, given.true), read(other, felt), strict=True):
        assert two == pytest.approx(one, rel=1e-9)


def test_the_law_of_the_load_is_told_by_a_bag_alone(view, record):
    tyre = TRUE_EFFECTS[SYSTEM]["tyre_relaxation"]
    difference = view.probe.effect(tyre, 1.0)
    seen = Sensitivity({tyre.name: difference}, {tyre.name: 1.0}, view.seen.nuisances)
    one = View("visible", view.probe, seen, {tyre.name: difference}, {tyre.name: tyre}, {}, {})
    assert told(through(one, Door("bag"), record[2]))["unseen"] == []
    assert told(through(one, Door("csv"), record[2]))["unseen"] == [tyre.name]
    without = Door("bag", ("load_command",))
    assert told(through(one, without, record[2]))["unseen"] == [tyre.name]


def test_what_can_hardly_be_seen_is_not_the_same_as_everything():
    axes = np.eye(8)
    seen = Sensitivity({"this": axes[0], "like": axes[0] + 0.1 * axes[1], "other": axes[2]},
        {"this": 1.0, "like": 1.0, "other": 1.0}, np.zeros((8, 1)))  # fmt: skip
    assert seen.mistaken("this", 3.0 * axes[0]) == ["like"]
    assert seen.mistaken("this", np.zeros(8)) == []
