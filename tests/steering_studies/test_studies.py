"""Studies beyond the source: answers that must hold, and the command that gives them."""

from dataclasses import replace
from itertools import pairwise

import numpy as np
import pytest

from steering_bringup.cli import main
from steering_core.parameters import load_parameters
from steering_studies.beyond import (
    end_of_stroke,
    energy,
    heavy_vehicle,
    losses,
    sensorless,
    two_stage,
)
from steering_studies.beyond.all_studies import STUDIES
from steering_studies.beyond.loop import closed_loop
from steering_studies.beyond.study import simulate
from steering_studies.beyond.supply_unit import SupplyUnit
from steering_studies.beyond.two_stage_valve import MainStage, TwoStageValve
from steering_studies.pages.study import study_page


def test_straight_ahead_costs_what_pump_and_leakage_say():
    """By hand: the pump's flow at 9.8 bar is 114 W; the closed centre leaks 5 W (targets)."""
    found = energy.powers("straight ahead", {}, energy.Drives())
    assert found["open centre"].gear == pytest.approx(114.0, rel=0.02)
    assert found["closed centre"].gear == pytest.approx(4.9, rel=0.1)
    assert found["electric"].gear == pytest.approx(10.0, abs=0.1)
    assert found["open centre"].engine > 1.5 * found["open centre"].gear


def test_shares_of_the_cycle_are_a_whole():
    assert sum(share for share, _ in energy.PARTS.values()) == pytest.approx(1.0)


def test_the_heavy_vehicle_s_boost_curve_is_fig_2_3_s():
    made = heavy_vehicle.STUDY.answer({})
    assert made.numbers["boost_at_10_Nm_Pa"] == pytest.approx(150e5, rel=0.01)
    assert made.numbers["parking_load_pressure_difference_Pa"] < 1e5
    assert made.numbers["driving_load_pressure_difference_Pa"] < 1e5
    assert load_parameters("heavy_vehicle").changed()["mechanics.piston_area"] == 5e-3
    assert "fig 2.3" in study_page(heavy_vehicle.STUDY, made).render()


def test_the_command_lists_its_questions_and_names_the_nearest(capsys):
    assert main(["study"]) == 0
    listed = capsys.readouterr().out
    assert all(name in listed for name in STUDIES)
    assert main(["study", "enrgy"]) == 1
    assert "did you mean 'energy'" in capsys.readouterr().err


def test_an_accumulator_gives_back_what_its_gas_says():
    """By hand: p V^n is constant; one litre out of two, gas at 100 bar, n = 1.3."""
    unit = SupplyUnit(flow=0.0, gas_volume=2e-3, precharge=1e7, pressure=2e7)
    before = (2e7 + 1e5) * unit.gas(2e7) ** 1.3
    for _ in range(1000):
        unit.step(1e-4, 1e-3)
    assert unit.gas(unit.pressure) == pytest.approx(unit.gas(2e7) + 1e-4, rel=1e-6)
    assert (unit.pressure + 1e5) * unit.gas(unit.pressure) ** 1.3 == pytest.approx(before, rel=1e-6)


def test_a_charging_valve_switches_with_hysteresis():
    unit = SupplyUnit()
    found = [unit.step(2e-5, 1e-3) for _ in range(60_000)]
    assert 0.98 * unit.low < min(found)
    assert max(found) < 1.02 * unit.high
    switches = sum(a != b for (_, a), (_, b) in pairwise(unit.history))
    assert 2 <= switches < 60


def test_the_loop_by_hand_is_the_direct_runner_s():
    document = {**losses.DRIVE, "duration": 1.0}
    trace = simulate(document, {})
    made = closed_loop(document, {})
    np.testing.assert_array_equal(made.measured[:, :3], trace.torque)
    np.testing.assert_array_equal(made.measured[:, 3:6], trace.pressure)
    np.testing.assert_array_equal(made.driver, trace.driver[:, 0])


def test_without_supply_the_wheel_can_still_be_turned():
    """The regulation's limit is kept by the torsion bar alone; a loss on one side pulls."""
    lost = closed_loop(losses.DRIVE, {}, **losses.LOSSES["supply"])
    assert losses.effort(lost) < losses.LEGAL_EFFORT_N
    late = lost.time > losses.LOST_AT_S + 1.0
    assert np.max(np.abs(lost.load_pressure[late])) < 2e5
    sound = closed_loop(losses.DRIVE, {})
    assert losses.effort(lost) > 1.5 * losses.effort(sound)


def test_without_pressure_sensors_the_valve_s_own_accuracy_is_left():
    document = {**sensorless.CYCLES["parking"], "duration": 5.0}
    blind = sensorless.without_sensors(document, {})
    error = blind.load_pressure - (blind.references[:, 1] - blind.references[:, 0])
    assert 0.2e5 < np.std(error) < 2e5


def test_the_oil_spring_stiffens_towards_the_stroke_s_end():
    """Equations: 764 rad/s in the middle, some 1600 at the very end of the stroke."""
    calm, _ = end_of_stroke.ripple(530.0, 200.0, {})
    rough, _ = end_of_stroke.ripple(530.0, 700.0, {})
    assert calm < 0.1e5 < rough


def test_the_second_stage_s_loop_is_what_its_sizes_say():
    """The closed form of the module's docstring against the nonlinear rates, linearised."""
    sheet = load_parameters()
    valve, hertz = TwoStageValve(sheet), np.array([10.0, 30.0, 100.0])
    y = valve.run(valve.rest(60e5), 60e5, 4.0 / 6e4, 0.35)[1]
    w, s = valve.corners(y, 60e5, 4.0 / 6e4), 2j * np.pi * hertz
    spool = 1.0 / (1.0 + 2.0 * 0.8 * s / w.spool + (s / w.spool) ** 2)
    simple = w.crossover / (s + w.load) * (1.0 + w.integral / s) * spool
    ratio = simple / valve.loop_gain(y, 60e5, 4.0 / 6e4, hertz)
    assert np.all(np.abs(20.0 * np.log10(np.abs(ratio))) < 1.5)
    assert np.all(np.abs(np.degrees(np.angle(ratio))) < 12.0)


def test_two_stages_hold_the_pressure_where_one_gives_way():
    made = two_stage.held(load_parameters(), 60e5, np.array([-2e-4, 0.0, 2e-4]), MainStage())
    assert made.worst(made.double) < 1e5
    assert made.worst(made.single) > 30e5
    assert min(m.phase for m in made.margins) > 45.0
    assert min(m.gain for m in made.margins) > 2.0


def test_too_small_a_pilot_volume_takes_the_margin_away():
    """The guard of the sizing rule w_i < w_c: ten times the integral corner swings."""
    small = replace(MainStage(), pilot_volume=1e-6)
    made = two_stage.held(load_parameters(), 60e5, np.array([2e-4]), small)
    assert np.isnan(made.double[0]) or made.margins[0].phase < 20.0
