"""The command, as a user would: a run with a hidden effect, diagnosed, and its extension run."""

import json

import numpy as np
import pytest

from steering_bringup.cli import main
from steering_diagnosis.report import Report

SENSORS = {
    "angle_sensor.noise": 2e-4,
    "torque_sensor.noise": 0.005,
    "left_pressure_sensor.noise": 3e3,
    "right_pressure_sensor.noise": 3e3,
    "supply_pressure_sensor.noise": 3e3,
    "rack_position_sensor.noise": 5e-6,
    "rack_force_sensor.noise": 5.0,
}
NOISE = [word for name, value in SENSORS.items() for word in ("--set", f"{name}={value}")]


@pytest.fixture(scope="module")
def bag(tmp_path_factory):
    folder = tmp_path_factory.mktemp("drive")
    options = ["--direct", "--duration", "10", "--node-set", "open_centre", "--out", str(folder)]
    hidden = ["--set", "effects.cross_piston_leakage.leakage=3e-12"]
    assert main(["run", "on_centre", *options, *hidden, *NOISE]) == 0
    return folder / "open_centre"


def test_a_hidden_leakage_is_named_measured_and_runs_as_an_extension(bag, tmp_path, capsys):
    out = tmp_path / "diagnosis"
    assert main(["diagnose", str(bag), "--out", str(out), "--jobs", "1"]) == 0
    told = capsys.readouterr().out
    assert "verdict: named" in told
    report = Report.model_validate(json.loads((out / "report.json").read_text()))
    (cause,) = report.causes
    assert cause.effect == "cross_piston_leakage"
    estimate = cause.parameters["leakage"]
    assert estimate.value == pytest.approx(3e-12, rel=0.15)
    assert estimate.low < 3e-12 < estimate.high
    assert max(cause.gain.values()) > 0.8
    assert (out / "report.html").stat().st_size > 1e6
    run = ["run", "step", "--node-set", "open_centre", "--direct", "--no-record"]
    assert main([*run, "--set-file", str(out / "extension.yaml")]) == 0


@pytest.mark.parametrize(
    ("scenario", "noise"),
    [("on_centre", NOISE), ("step", NOISE), ("ramp", []), ("step", [])],
    ids=["on_centre", "step", "ramp without noise", "step without noise"],
)
def test_a_run_without_a_hidden_effect_is_clean(scenario, noise, tmp_path, capsys):
    options = ["--direct", "--duration", "10", "--node-set", "open_centre", "--out", str(tmp_path)]
    assert main(["run", scenario, *options, *noise]) == 0
    out = tmp_path / "diagnosis"
    assert main(["diagnose", str(tmp_path / "open_centre"), "--out", str(out), "--jobs", "1"]) == 0
    assert "verdict: clean" in capsys.readouterr().out


def test_what_cannot_be_diagnosed_is_one_line(tmp_path, capsys, monkeypatch):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "drive.csv").write_text("t,a\n" + "\n".join(f"{k},1" for k in range(300)))
    for arguments, words in (
        (["diagnose", "nowhere"], "nowhere"),
        (["diagnose", "drive.csv"], "needs a mapping file"),
        (["plan", "nowhere"], "nowhere"),
    ):
        assert main(arguments) == 1
        error = capsys.readouterr().err
        assert words in error
        assert error.count("\n") == 1


def test_a_straight_drive_excites_nothing(tmp_path, capsys):
    options = ["--direct", "--duration", "4", "--node-set", "open_centre", "--out", str(tmp_path)]
    assert main(["run", "straight_ahead", *options, *NOISE]) == 0
    out = tmp_path / "diagnosis"
    assert main(["diagnose", str(tmp_path / "open_centre"), "--out", str(out), "--jobs", "1"]) == 0
    assert "insufficient excitation" in capsys.readouterr().out
    assert np.isfinite((out / "report.html").stat().st_size)
