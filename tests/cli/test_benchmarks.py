"""Every benchmark in its smallest size: its rows measured, the truth in last line and status."""

import json
import math
import os
import runpy
import subprocess
import sys
from pathlib import Path

import pytest

from steering_bringup.benchmarking.program import Measured, main
from steering_bringup.benchmarking.registry import BENCHMARKS
from steering_bringup.benchmarking.rows import Row, missed, verdict
from steering_bringup.cli import bench
from steering_bringup.cli import main as steer

ROOT = Path(__file__).parents[2]
LEFT_OUT = {
    "effects_speed": {"open_centre"},
    "graph_speed": {"each"},
    "replay_speed": {"open_centre"},
    "rig_mistakes": {"effects"},
    "rig_link": {"bare_can", "graph"},
}
"""Rows that the smallest size has not, by how their names begin."""


@pytest.fixture
def quick(tmp_path, monkeypatch, capsys):
    """Run a benchmark; return its status, the lines that it printed, and its numbers.

    What needs no ROS runs in this process, where the kernels of other tests are loaded already.
    """
    file = tmp_path / "numbers.json"

    def run(name):
        words = [str(ROOT / "benchmarks" / f"{name}.py"), "--quick", "--json", str(file)]
        if BENCHMARKS[name].ros:
            environment = {**os.environ, "PYTHONPATH": os.pathsep.join(p for p in sys.path if p)}
            command = [sys.executable, *words]
            done = subprocess.run(
                command, env=environment, capture_output=True, text=True, timeout=240
            )
            status, printed = done.returncode, done.stdout
            assert file.is_file(), done.stdout + done.stderr
        else:
            monkeypatch.setattr(sys, "argv", words)
            with pytest.raises(SystemExit) as left:
                runpy.run_path(words[0], run_name="__main__")
            assert isinstance(left.value.code, int)
            status, printed = left.value.code, capsys.readouterr().out
        return status, printed.rstrip().splitlines(), json.loads(file.read_text())

    return run


@pytest.mark.parametrize(
    "name", [pytest.param(b.name, marks=[pytest.mark.ros] * b.ros) for b in BENCHMARKS.values()]
)
def test_a_benchmark_measures_its_rows_and_tells_what_it_missed(name, quick):
    if BENCHMARKS[name].ros:
        pytest.importorskip("rclpy")
    status, printed, numbers = quick(name)
    assert numbers["quick"]
    rows = numbers["rows"]
    for row in BENCHMARKS[name].rows:
        entry = rows[row.name]
        if row.name.startswith(tuple(LEFT_OUT.get(name, ()))):
            assert entry["value"] is None
        else:
            assert math.isfinite(entry["value"])
            assert entry["reached"] is row.reached(entry["value"])
    below = missed(rows)
    assert status == (1 if below else 0)
    assert printed[-1] == verdict(name, rows)
    assert all(line in printed[-1] for line in below)
    exact = EXACT.get(name, lambda numbers: None)
    exact(numbers)


def nothing_lost(numbers):
    recorded = numbers["details"]["recorded"]
    assert len(recorded["missing"]) == 10
    assert recorded["messages"] == 2 * (8 * 1000 + 2 * 100)
    assert set(recorded["missing"].values()) == {0}
    for topic in numbers["details"]["played"]["listener"].values():
        assert topic["lost"] == 0
        assert topic["received"] >= 1000


def as_accurate_as_lsoda(numbers):
    """The tolerance of LSODA is the loosest of the scan that keeps the plant's error."""
    rows, details = numbers["rows"], numbers["details"]
    error = rows["state_error"]["value"]
    kept = [s["tolerance"] for s in details["lsoda_scan"] if s["error"] <= error]
    assert details["lsoda_tolerance"] == max(kept)
    assert rows["pressure_error"]["value"] < 0.01
    assert rows["memory_growth"]["value"] < 1.5


def nothing_alive(numbers):
    assert numbers["rows"]["alive"]["value"] == 0
    assert numbers["rows"]["tried"]["value"] >= 7


def no_message_lost(numbers):
    assert numbers["rows"]["lost"]["value"] == 0


EXACT = {
    "direct_speed": as_accurate_as_lsoda,
    "graph_speed": no_message_lost,
    "record_while_playing": nothing_lost,
    "overlay_mutants": nothing_alive,
}
"""What holds on any machine, however busy."""


def test_each_program_has_an_entry_and_each_entry_a_program():
    programs = {p.stem for p in (ROOT / "benchmarks").glob("[!_]*.py")}
    assert programs == set(BENCHMARKS)


@pytest.mark.parametrize(
    ("row", "value", "reached"),
    [
        (Row("a", ""), 1.0, None),
        (Row("a", "", at_least=2.0), 2.0, True),
        (Row("a", "", at_least=2.0), 1.99, False),
        (Row("a", "", at_least=2.0), math.nan, False),
        (Row("a", "", at_most=2.0), 2.0, True),
        (Row("a", "", at_most=2.0), 2.01, False),
        (Row("a", "", at_most=2.0), math.nan, False),
        (Row("a", "", at_most=2.0), None, None),
    ],
)
def test_a_target_is_met_or_not(row, value, reached):
    assert row.reached(value) is reached


@pytest.mark.parametrize(
    ("value", "digits", "text"),
    [
        (441.3, 2, "440"),
        (0.000149, 2, "0.00015"),
        (9.96, 2, "10.0"),
        (-0.0412, 2, "-0.041"),
        (338.0, 3, "338"),
        (164000.0, 0, "164000"),
        (0.0, 2, "0"),
        (math.nan, 2, "nan"),
        (None, 2, "-"),
    ],
)
def test_a_figure_has_its_significant_digits(value, digits, text):
    assert Row("a", "", digits=digits).text(value) == text


def test_a_missed_target_is_in_the_last_line_and_in_the_status(capsys, tmp_path):
    def measure(options):
        return Measured({"alive": 2 if options.much else 0, "tried": 9})

    def arguments(parser):
        parser.add_argument("--much", action="store_true")

    words = ["--json", str(tmp_path / "n.json")]
    assert main("overlay_mutants", measure, arguments, "", words) == 0
    assert capsys.readouterr().out.splitlines()[-1] == "overlay_mutants: 1 of 1 targets met"
    assert main("overlay_mutants", measure, arguments, "", [*words, "--much"]) == 1
    last = capsys.readouterr().out.splitlines()[-1]
    assert last == "overlay_mutants: 1 of 1 targets missed: alive 2 (at most 0)"


def test_a_value_without_a_row_is_refused():
    def measure(options):
        return Measured({"alife": 0})

    with pytest.raises(ValueError, match="no row alife"):
        main("overlay_mutants", measure, lambda parser: None, "", [])


MISSED = "import json,sys\njson.dump({'rows':{'a':{'value':1,'text':'1','target':'at least 2',\
'reached':False}}},open(sys.argv[2],'w'))\nsys.exit(%d)\n"


@pytest.mark.parametrize(
    ("program", "expected"),
    [
        ("raise SystemExit(1)\n", "steer bench: not measured: overlay_mutants\n"),
        ("import nowhere\n", "steer bench: not measured: overlay_mutants\n"),
        (MISSED % 1, "steer bench: 1 of 1 targets missed: overlay_mutants.a 1 (at least 2)\n"),
        (MISSED % 0, "steer bench: not measured: overlay_mutants\n"),
    ],
)
def test_the_command_tells_what_went_wrong(program, expected, tmp_path, monkeypatch, capsys):
    (tmp_path / "benchmarks").mkdir()
    (tmp_path / "benchmarks" / "overlay_mutants.py").write_text(program)
    monkeypatch.setattr(bench, "project", lambda: tmp_path)
    file = tmp_path / "bench.json"
    assert steer(["bench", "overlay_mutants", "--json", str(file)]) == 1
    assert capsys.readouterr().err == expected


def test_figures_are_not_taken_from_a_quick_run(capsys):
    assert steer(["bench", "--quick", "--readme"]) == 1
    assert "leave --quick out" in capsys.readouterr().err
