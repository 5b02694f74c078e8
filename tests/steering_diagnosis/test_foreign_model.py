"""``steer diagnose --model``: an FMU of any machine, on the files that the bench reads."""

import json
from importlib import import_module
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import yaml

from steering_bringup.cli import main
from steering_core.errors import BenchError
from steering_diagnosis.data.any_machine import load_any_mapping, read_any

EXAMPLES = Path(__file__).parents[2] / "src" / "balance_diagnosis" / "examples" / "fmu"
FORCE_PER_KILONEWTON = 1e3

BINDING: dict[str, Any] = {
    "schema": 1,
    "name": "axis",
    "inputs": {"x": "x", "v": "v", "a": "a", "sign": "sign"},
    "outputs": {"force": "force"},
    "parameters": {
        "mass": {"nominal": 95.0, "tolerance": 0.2, "unit": "kg"},
        "viscous": {"nominal": 200.0, "tolerance": 0.5},
        "coulomb": {"nominal": 20.0, "tolerance": 0.5},
    },
    "causes": {
        "spring": {"spring": {"neutral": 0.0, "low": -1e3, "high": 1e3, "unit": "N/m"}},
        "force offset": {"offset": {"neutral": 0.0, "low": -100.0, "high": 100.0}},
    },
    "data": {
        "time": "t",
        "channels": {
            **{name: {"from": name} for name in ("x", "v", "a", "sign")},
            "force": {"from": "F", "unit": "N", "scale": FORCE_PER_KILONEWTON},
        },
    },
}


def measured(file, seed):
    """Write a file as a spreadsheet with a German locale saves it; the force is in kN."""
    draw = np.random.default_rng(seed)
    t = 0.005 * np.arange(1200)
    w = 2.0 + 0.1 * seed
    x, v, a = 0.1 * np.sin(w * t), 0.1 * w * np.cos(w * t), -0.1 * w**2 * np.sin(w * t)
    sign = np.tanh(v / 1e-3)
    force = 97.0 * a + 180.0 * v + 21.0 * sign + 150.0 * x + 0.3 * draw.standard_normal(len(t))
    rows = np.stack([t, x, v, a, sign, force / FORCE_PER_KILONEWTON], axis=1)
    lines = [";".join(f"{n:.7f}".replace(".", ",") for n in row) for row in rows]
    file.write_text("\n".join(["t;x;v;a;sign;F", *lines]) + "\n")
    return file


def bound(folder, **data):
    file = folder / "axis.yaml"
    file.write_text(yaml.safe_dump({**BINDING, "data": {**BINDING["data"], **data}}))
    return file


def test_the_command_names_the_cause_and_writes_its_files(tmp_path, capsys, monkeypatch):
    monkeypatch.syspath_prepend(str(EXAMPLES))
    fmu = import_module("make").make("emps_axis", tmp_path)
    given = ["--model", str(fmu), "--mapping", str(bound(tmp_path))]
    data, held = (str(measured(tmp_path / f"{day}.csv", k)) for k, day in enumerate("ab"))
    out = tmp_path / "out"
    assert main(["diagnose", data, *given, "--holdout", held, "--out", str(out)]) == 0
    said = capsys.readouterr().out
    assert "verdict: named. Named: spring (spring" in said
    report = json.loads((out / "report.json").read_text("utf-8"))
    found = report["causes"]["spring"]["spring"]
    assert found["low"] < 150.0 < found["high"]
    assert report["records"][1]["held_out"]
    assert report["call"].startswith(f"./steer diagnose {data} --model")
    assert {p.name for p in out.iterdir()} == {"page.html", "report.json", "extended_model.yaml"}


def test_a_file_keeps_its_units_and_is_cut(tmp_path):
    places = load_any_mapping(bound(tmp_path), BINDING["inputs"])
    record, notes = read_any(measured(tmp_path / "a.csv", 0), places, 1.0, 3.0)
    assert record.times[0] == 0.0
    assert record.times[-1] == pytest.approx(2.0)
    assert record.units == {"force": "N"}
    assert np.std(record["force"]) > 10.0
    assert any("200 Hz" in note for note in notes)


@pytest.mark.parametrize(
    ("data", "told"),
    [
        ({"valve_system": "open_centre"}, "valve_system belongs to a steering gear"),
        ({"channels": {"x": {"from": "x"}}}, "lacks the model's channel 'v'"),
        ({"tme": "t"}, "tme"),
        ({"time_unit": "parsec"}, "time_unit must be one of"),
    ],
)
def test_a_mapping_that_does_not_fit_is_told_with_its_place(tmp_path, data, told):
    file = bound(tmp_path, **data)
    with pytest.raises(BenchError) as caught:
        load_any_mapping(file, BINDING["inputs"])
    assert told in str(caught.value)
    assert str(file) in str(caught.value)


def test_channels_on_other_clocks_meet_on_the_slowest_and_gaps_stay_gaps(tmp_path):
    import scipy.io

    fast, slow = 0.001 * np.arange(3000), 0.01 * np.arange(300)
    kept = (fast < 1.0) | (fast > 1.5)
    scipy.io.savemat(
        tmp_path / "two.mat", {"tf": fast[kept], "ts": slow, "f": fast[kept], "s": 2.0 * slow}
    )
    file = tmp_path / "two.yaml"
    channels = {"fast": {"from": "f", "time": "tf"}, "slow": {"from": "s", "time": "ts"}}
    file.write_text(yaml.safe_dump({"data": {"channels": channels}}))
    record, _ = read_any(tmp_path / "two.mat", load_any_mapping(file, channels))
    assert np.allclose(record["slow"], 2.0 * record.times)
    gap = (record.times > 0.9995) & (record.times < 1.5005)
    assert np.array_equal(np.isnan(record["fast"]), gap)
    assert np.allclose(record["fast"][~gap], record.times[~gap])


def test_without_a_mapping_or_with_a_bag_the_command_says_what_is_missing(tmp_path, capsys):
    assert main(["diagnose", "a.csv", "--model", "a.fmu", "--out", str(tmp_path / "o")]) == 1
    assert "needs a mapping file: --mapping FILE" in capsys.readouterr().err
