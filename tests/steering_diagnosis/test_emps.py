"""The engine on a real machine: its records are found through STEER_EMPS_DATA, or it is skipped."""

import os
from pathlib import Path

import numpy as np
import pytest
from dask_here import dask_executor
from scipy.io import savemat

from steering_bringup.cli import main
from steering_core.errors import BenchError
from steering_diagnosis.emps.data import PULSES, Axis, read_axis
from steering_diagnosis.emps.diagnose_axis import PUBLISHED, SETTINGS, diagnose_axis
from steering_diagnosis.emps.replay import HYPOTHESES, LAWS, AxisReplay
from steering_diagnosis.engine.diagnose import diagnose

FOLDER = os.environ.get("STEER_EMPS_DATA", "")


@pytest.fixture(scope="module")
def made():
    if not FOLDER:
        pytest.skip("STEER_EMPS_DATA does not say where the EMPS benchmark's records are")
    return diagnose_axis(FOLDER)


def test_friction_by_direction_is_named_and_nothing_else(made):
    (cause,) = made.findings.causes
    assert cause.hypothesis.name == "viscous_asymmetry"
    assert not cause.ambiguous_with
    assert cause.parameters["difference"].value == pytest.approx(-39.0, abs=3.0)


def test_the_published_errors_are_reached_also_on_the_record_that_was_not_fitted(made):
    assert made.errors["named, estimation"] <= PUBLISHED["by direction, estimation"]
    assert made.errors["symmetric, estimation"] <= PUBLISHED["symmetric, estimation"]
    # On the pulses the authors print the symmetric model's error only: 5.98 %.
    assert made.errors["named, pulses"] < 1.01 * PUBLISHED["symmetric, pulses"]
    assert made.errors["named, pulses"] < 0.93 * made.errors["symmetric, pulses"]


def test_the_mode_above_15_hz_in_the_pulses_stays_unexplained(made):
    (cause,) = made.pulses.causes
    assert cause.hypothesis.name == "viscous_asymmetry"
    bands = [region.band_hz for region in made.pulses.unexplained]
    assert any(low > 14.0 and high > 25.0 for low, high in bands)


def axis(extra=None, seed=1, seconds=20.0) -> Axis:
    """Return an axis that obeys the nominal model, and what ``extra`` (x, v) adds [N]."""
    t = np.arange(0.0, seconds, 1e-3)
    position = 0.11 * np.sin(2.0 * np.pi * 0.15 * t) * np.cos(2.0 * np.pi * 0.02 * t)
    speed, random = np.gradient(position, 1e-3), np.random.default_rng(seed)
    force = 97.0 * np.gradient(speed, 1e-3) + 190.0 * speed + 21.0 * np.tanh(speed / 1e-3)
    force += 0.0 if extra is None else extra(position, speed)
    noisy = position + 1e-7 * random.normal(size=len(t))
    return Axis(noisy, force + 1.0 * random.normal(size=len(t)), Path("made"))


def names(made) -> set[str]:
    return {cause.hypothesis.name for cause in made.causes}


def test_a_clean_axis_is_clean():
    assert diagnose(AxisReplay(axis()), settings=SETTINGS).verdict == "clean"


def test_made_causes_are_found_and_measured():
    found = diagnose(AxisReplay(axis(lambda x, v: 40.0 * np.abs(v))), settings=SETTINGS)
    assert names(found) == {"viscous_asymmetry"}
    assert found.causes[0].parameters["difference"].value == pytest.approx(40.0, rel=0.15)


def test_every_hypothesis_has_its_law_and_is_neutral_without_it():
    assert set(LAWS) == set(HYPOTHESES)
    replay = AxisReplay(axis(seconds=4.0))
    base = replay.predicted({}, {})
    for name, hypothesis in HYPOTHESES.items():
        neutral = {p.name: p.neutral for p in hypothesis.parameters}
        np.testing.assert_allclose(replay.predicted({}, {name: neutral}), base, atol=1e-9)


def test_files_of_something_else_are_named(tmp_path):
    with pytest.raises(BenchError, match="no record"):
        read_axis(tmp_path / PULSES)
    savemat(tmp_path / PULSES, {"qm": np.zeros(3000)})
    with pytest.raises(BenchError, match="lacks 'vir'"):
        read_axis(tmp_path / PULSES)


def test_two_causes_at_once_are_both_named():
    both = axis(lambda x, v: 40.0 * np.abs(v) + 60.0 * x, seconds=30.0)
    found = diagnose(AxisReplay(both), settings=SETTINGS)
    assert names(found) == {"viscous_asymmetry", "position_dependent_force"}


def test_what_the_catalogue_lacks_is_unexplained_and_gets_no_name():
    """A worn screw: a force that repeats along it, every 9 mm."""
    worn = axis(lambda x, v: 6.0 * np.sin(2.0 * np.pi * x / 0.009), seconds=30.0)
    found = diagnose(AxisReplay(worn), settings=SETTINGS)
    assert found.verdict == "unexplained"
    assert not found.causes


def test_the_answer_is_the_same_here_and_on_a_distributed_engine():
    """Dask's executor stands behind the same interface as a pool of processes."""
    replay = AxisReplay(axis(lambda x, v: 40.0 * np.abs(v), seconds=12.0))
    here = diagnose(replay, settings=SETTINGS)
    with dask_executor() as executor:
        there = diagnose(replay, executor=executor, settings=SETTINGS)
    assert here.nuisances == there.nuisances
    assert here.effects == there.effects
    assert here.verdict == there.verdict


def test_the_command_writes_the_page_of_the_library(tmp_path, capsys):
    if not FOLDER:
        pytest.skip("STEER_EMPS_DATA does not say where the EMPS benchmark's records are")
    assert main(["diagnose-emps", FOLDER, "--out", str(tmp_path / "page")]) == 0
    said = capsys.readouterr().out
    assert "by the library alone: named. Named: viscous friction by direction" in said
    page = (tmp_path / "page" / "page.html").read_text("utf-8")
    assert "held-out &#x27;DATA_EMPS_PULSES&#x27;" in page
    assert "./steer diagnose-emps" in page
