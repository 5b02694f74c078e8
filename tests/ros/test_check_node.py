"""``steer check-node`` on real processes: good nodes pass, each bad one fails for its reason."""

import json
import sys
from pathlib import Path

import pytest
from bench_process import Bench

pytest.importorskip("rclpy")
pytestmark = pytest.mark.ros

GUESTS = Path(__file__).parents[1] / "support" / "guests.py"


def check(folder, *words, modules=()):
    bench = Bench("check-node", *words, "--json", "out.json", folder=folder, modules=modules)
    status, out, err = bench.finish()
    assert not bench.left_over()
    assert err == ""
    report = json.loads((folder / "out.json").read_text())
    assert report["passed"] == (status == 0)
    return status, out, {v["fault"]: v for v in report["verdicts"]}


def guest(manner, *faults):
    return (sys.executable, str(GUESTS), manner, "--faults", *faults)


def test_a_careful_node_passes(tmp_path):
    status, out, verdicts = check(tmp_path, *guest("well", "inputs-nan", "killed"))
    assert status == 0, out
    assert "took it as silent" in verdicts["killed"]["arbiter"]
    assert out.endswith("2 of 2 passed\n")


def test_a_careless_node_fails_where_its_inputs_do(tmp_path):
    words = guest("careless", "inputs-stop", "inputs-nan")
    status, out, verdicts = check(tmp_path, *words)
    assert status == 1
    assert "goes on asking for 2 N m without inputs" in verdicts["inputs-stop"]["change"]
    assert "no number" in verdicts["inputs-nan"]["change"]
    assert "refused" in verdicts["inputs-nan"]["arbiter"]
    assert "0 of 2 passed" in out


def test_a_node_without_a_name_that_speaks_in_bursts_is_told_so(tmp_path):
    _, _, verdicts = check(tmp_path, *guest("in_bursts", "none"))
    assert "names no source" in verdicts["none"]["change"]
    assert "of the time: its messages come every" in verdicts["none"]["change"]


def test_a_node_that_ends_is_told_with_its_last_words(tmp_path):
    status, out, verdicts = check(tmp_path, *guest("absent", "none", "silent"))
    assert status == 1
    assert "ended with status 1: no such camera" in verdicts["none"]["node"]
    assert "0 of 1 passed" in out


def test_the_lane_keeper_passes_as_a_member(tmp_path):
    faults = ("nan", "driver", "inputs-nan")
    status, out, verdicts = check(tmp_path, "lane_keeper", "--faults", *faults)
    assert status == 0, out
    assert "not finite" in verdicts["inputs-nan"]["node"]
    assert "left 0% to it" in verdicts["driver"]["arbiter"]


def test_a_command_that_is_not_there_is_one_line(tmp_path):
    status, _, err = Bench("check-node", "no_such_program", folder=tmp_path).finish()
    assert status == 1
    assert (
        err == "steer check-node: 'no_such_program' cannot be started: No such file or directory\n"
    )


def test_an_unknown_fault_is_refused_with_the_nearest(tmp_path):
    words = ("check-node", "true", "--faults", "killd")
    _, _, err = Bench(*words, folder=tmp_path).finish()
    assert "did you mean 'killed'" in err or "nearest" in err
