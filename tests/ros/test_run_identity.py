"""One run, many ways: the recorded bytes are the same whatever the layout, load or runner."""

import subprocess
import sys
from pathlib import Path

import pytest
from bench_process import Bench

from steering_bringup.bags import first_difference, read_bag

pytest.importorskip("rclpy")
pytestmark = pytest.mark.ros

DURATION = "1.2"
NODE_SETS = ("open_centre", "closed_centre")
WAYS = {"graph, one process": (), "graph, a process each": ("--processes", "each")}
BUSY = "while True: pass"


def run(folder: Path, *words: str) -> Path:
    """Run to the end and return the results' folder."""
    status, out, err = Bench("run", *words, "--out", "out", folder=folder).finish()
    assert status == 0, err
    assert " 0 lost" in out
    return folder / "out"


@pytest.fixture(scope="module")
def direct(tmp_path_factory):
    """The direct runner's bags of the main job's first ticks."""
    folder = tmp_path_factory.mktemp("direct")
    return run(folder, "--direct", "--duration", DURATION)


def assert_same(left: Path, right: Path, ticks: int = 1200) -> None:
    first, second = read_bag(left), read_bag(right)
    assert len(first["/steering/torque"]) == ticks
    assert first_difference(first, second) is None


@pytest.mark.parametrize("way", WAYS)
def test_graph_and_direct_runner_leave_the_same_bytes(way, direct, tmp_path):
    graph = run(tmp_path, "--duration", DURATION, *WAYS[way])
    for name in NODE_SETS:
        assert_same(direct / name, graph / name)


def test_the_servo_rig_is_the_same_on_both_runners(tmp_path):
    """Controllers of another kind, the load cylinder's chain of commands, and a delay on it."""
    late = ("--delay", "/load_cylinder/command->plant=1")
    words = ("servo_on_centre", "--duration", "1", *late)
    (tmp_path / "graph").mkdir()
    (tmp_path / "direct").mkdir()
    graph = run(tmp_path / "graph", *words) / "servo_rig"
    other = run(tmp_path / "direct", *words, "--direct") / "servo_rig"
    assert_same(graph, other, 1000)


def test_a_loaded_machine_changes_nothing(direct, tmp_path):
    load = [subprocess.Popen([sys.executable, "-c", BUSY]) for _ in range(3)]
    try:
        graph = run(tmp_path, "--duration", DURATION, "--node-set", "closed_centre")
    finally:
        for process in load:
            process.kill()
            process.wait()
    assert_same(direct / "closed_centre", graph / "closed_centre")


def test_two_runs_at_once_do_not_hear_each_other(direct, tmp_path):
    words = ("run", "--duration", DURATION)
    pair = [Bench(*words, "--node-set", name, "--out", name, folder=tmp_path) for name in NODE_SETS]
    for bench in pair:
        status, _, err = bench.finish()
        assert status == 0, err
    for name in NODE_SETS:
        assert_same(direct / name, tmp_path / name / name)


@pytest.fixture
def changed(tmp_path):
    """Options that change a parameter, add delays and effects."""
    extension = tmp_path / "extension.yaml"
    extension.write_text(
        "mechanics: {rack_mass: 30}\n"
        "parameters: {valve_controller.resonance: 300}\n"
        "effects:\n"
        "  cross_piston_leakage: {leakage: 1.0e-12}\n"
        "  tyre_relaxation: {}\n"
    )
    delays = [
        "/steering/rack->vehicle=3",
        "/valve/left/command->plant=1",
        "/driver/torque->plant=2",
    ]
    return ["step", "--duration", "1", "--set-file", str(extension)] + [
        word for delay in delays for word in ("--delay", delay)
    ]


def test_delays_and_effects_are_the_same_on_both_runners(changed, direct, tmp_path):
    for name in ("plain", "graph", "direct"):
        (tmp_path / name).mkdir()
    graph = run(tmp_path / "graph", *changed) / "closed_centre"
    other = run(tmp_path / "direct", *changed, "--direct") / "closed_centre"
    plain = run(tmp_path / "plain", "step", "--duration", "1", "--direct") / "closed_centre"
    assert_same(graph, other, 1000)
    assert first_difference(read_bag(plain), read_bag(other)) is not None


def test_a_bag_is_enough_to_repeat_its_run(changed, tmp_path):
    bag = run(tmp_path, *changed) / "closed_centre"
    (tmp_path / "extension.yaml").unlink()
    for words in ((), ("--direct",)):
        status, out, err = Bench("repeat", str(bag), *words, folder=tmp_path).finish()
        assert status == 0, err
        assert "the same, bit for bit" in out
