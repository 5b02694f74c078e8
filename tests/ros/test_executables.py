"""The nodes' executables with the file of steer graph: the same bytes, and an end in order."""

import os
import shlex
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest
from bench_process import Bench, recorded_bytes, wait_for

from steering_bringup.bags import first_difference, read_bag
from steering_lockstep.domain import claim_domain
from steering_lockstep.executables import EXECUTABLES

pytest.importorskip("rclpy")
pytestmark = pytest.mark.ros

FUNCTIONS = {name: kind for kind, (_, name) in EXECUTABLES.items()}
AT_ONCE = 2.0
"""s for the end of a process, one on an idle machine."""


@pytest.fixture
def start(tmp_path, monkeypatch):
    """Start executables as ros2 run would; whatever is left of them ends with the test."""
    claim = claim_domain()
    claim.release()
    monkeypatch.setenv("ROS_DOMAIN_ID", str(claim.number))
    path = os.pathsep.join(p for p in sys.path if p)
    started = []

    def run(name, *words):
        function = FUNCTIONS.get(name, "any_kind")
        code = f"from steering_lockstep.executables import {function} as node; node()"
        started.append(
            subprocess.Popen(
                [sys.executable, "-c", code, *words],
                cwd=tmp_path,
                env={**os.environ, "PYTHONPATH": path},
                stderr=subprocess.PIPE,
                text=True,
            )
        )
        return started[-1]

    yield run
    for process in started:
        process.kill()
        process.communicate()


def graph_file(folder, *words):
    """Write the file of a run with ``steer graph``; return the lines that start its nodes."""
    status, out, err = Bench("graph", "step", *words, "--out", "g.json", folder=folder).finish()
    assert status == 0, err
    lines = [shlex.split(line) for line in out.splitlines()]
    assert all(line[:2] == ["ros2", "run"] for line in lines)
    return [line[3:] for line in lines]


def test_they_make_the_direct_runner_s_bytes_in_any_namespace(tmp_path, start):
    words = ("--duration", "0.2", "--set", "mechanics.rack_mass=30", "--set", "vehicle.speed=25")
    lines = graph_file(tmp_path, *words, "--record", "bag")
    # What the command line says counts before the file.
    changed = ["-p", "mechanics.rack_mass:=31.0"]
    ros = ["--ros-args", "-r", "__ns:=/car1", "-r", "driver/torque:=/hand", *changed]
    nodes = [start(*reversed_last(line), *ros) for line in lines]
    assert [node.wait(90) for node in nodes] == [0] * 6
    alone_words = ("--set", "mechanics.rack_mass=31", "--direct", "--out", "direct")
    Bench("run", "step", *words, *alone_words, folder=tmp_path).finish()
    recorded, alone = read_bag(tmp_path / "bag"), read_bag(tmp_path / "direct" / "closed_centre")
    assert len(recorded["/clock"]) == 200
    assert first_difference(recorded, alone) is None


def reversed_last(line):
    """The last node by the executable of any kind: it knows only its name."""
    return ["lockstep_node", *line[1:]] if line[-1] == "vehicle" else line


def test_signals_end_them_in_order(tmp_path, start):
    lines = graph_file(tmp_path, "--duration", "600", "--record", "bag", "--real-time")
    nodes = {line[-1]: start(*line) for line in lines}
    wait_for(lambda: (tmp_path / "bag").exists() and recorded_bytes(tmp_path / "bag") > 50_000, 90)
    ends = {}
    for name, process in reversed(nodes.items()):
        number = signal.SIGTERM if name in ("plant", "driver") else signal.SIGINT
        process.send_signal(number)
        sent = time.monotonic()
        _, text = process.communicate(timeout=10)
        assert time.monotonic() - sent < AT_ONCE
        assert f"{name}: told to end by {number.name} at tick " in text
        assert "Traceback" not in text
        ends[name] = process.returncode
    assert ends == {name: 143 if name in ("plant", "driver") else 0 for name in nodes}
    (note,) = read_bag(tmp_path / "bag").notes
    assert note.startswith("the run was broken off after ")


def test_before_a_node_is_up_a_signal_ends_it_without_a_word(tmp_path, start):
    graph_file(tmp_path)
    node = start("plant_node", "--graph", "g.json")
    wait_for(lambda: "rclpy" in Path(f"/proc/{node.pid}/maps").read_text())
    node.send_signal(signal.SIGINT)
    _, text = node.communicate(timeout=10)
    assert node.returncode == -signal.SIGINT
    assert text == ""


@pytest.mark.parametrize(
    ("words", "named"),
    [
        (("valve_controller_node", "--graph", "g.json"), "there is: valve_left, valve_right"),
        (("plant_node", "--graph", "none.json"), "no graph in 'none.json'"),
        (("lockstep_node", "--graph", "g.json"), "--name must name one node of the graph"),
        (
            ("plant_node", "--graph", "g.json", "--ros-args", "-p", "mechanics.rack_mas:=1.0"),
            "node 'plant' cannot start",
        ),
    ],
    ids=str,
)
def test_a_slip_is_one_line(words, named, tmp_path, start):
    graph_file(tmp_path)
    node = start(*words)
    _, text = node.communicate(timeout=60)
    assert node.returncode == 1
    assert text.startswith("error: ")
    assert named in text
    assert len(text.splitlines()) == 1
