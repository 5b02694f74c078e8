"""Studies beyond the source: answers that must hold, and the command that gives them."""

import pytest

from steering_bringup.cli import main
from steering_core.parameters import load_parameters
from steering_studies.beyond import energy, heavy_vehicle
from steering_studies.beyond.all_studies import STUDIES
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
    assert made.numbers["parking_load_pressure_difference_Pa"] < 5e5
    assert made.numbers["driving_load_pressure_difference_Pa"] < 1e5
    assert load_parameters("heavy_vehicle").changed()["mechanics.piston_area"] == 5e-3
    assert "fig 2.3" in study_page(heavy_vehicle.STUDY, made).render()


def test_the_command_lists_its_questions_and_names_the_nearest(capsys):
    assert main(["study"]) == 0
    listed = capsys.readouterr().out
    assert all(name in listed for name in STUDIES)
    assert main(["study", "enrgy"]) == 1
    assert "did you mean 'energy'" in capsys.readouterr().err
