"""Whatever happens in mid-run: the culprit is named, the bag is readable, nothing is left."""

import os
import re
import resource
import shutil
import signal
import subprocess
import time
from pathlib import Path

import pytest
import yaml
from bench_process import Bench, recorded_bytes, wait_for

from steering_bringup.bags import read_bag
from steering_bringup.shipped import shipped

pytest.importorskip("rclpy")
pytestmark = pytest.mark.ros

NODES = ("plant", "valve_left", "valve_right", "driver", "vehicle", "recorder")
LONG = ("run", "step", "--duration", "60", "--out", "out")
BAG = Path("out", "closed_centre")
BAD_DRIVER = """
from driver_model import driver_node


class Broken:
    def __init__(self, core):
        self.core = core
        self.out = core.out

    def step(self, tick, *measured):
        out = self.core.step(tick, *measured)
        if tick == 300:
            {fault}
        return out


def make(context, spec, run, parameters):
    build = driver_node.driver_builder(run.ticks)
    broken = lambda values: Broken(build(values))
    return driver_node.DriverNode(context, spec, run, parameters, broken)
"""


@pytest.fixture
def running(tmp_path):
    """Start a long run, a process a node, and wait until it records."""
    started = []

    def start(*words: str) -> Bench:
        bench = Bench(*LONG, *words, folder=tmp_path)
        started.append(bench)
        wait_for(lambda: bench.process.poll() is not None or recorded_bytes(tmp_path / BAG) > 1e5)
        assert bench.process.poll() is None, bench.finish()
        return bench

    yield start
    for bench in started:
        if bench.process.poll() is None:
            os.killpg(bench.process.pid, signal.SIGKILL)
            bench.process.wait()


def assert_tidy(bench: Bench, folder: Path) -> None:
    """The bag so far holds whole ticks; no process and no shared memory is left."""
    trace = read_bag(folder / BAG)
    ticks = trace["/steering/torque"]["tick"]
    assert len(ticks) >= 100
    assert ticks.tolist() == list(range(len(ticks)))
    wait_for(lambda: not bench.left_over(), 10.0)


@pytest.mark.parametrize("victim", ["driver", "recorder"])
def test_a_killed_node_is_named(running, victim, tmp_path):
    bench = running("--processes", "each")
    pids = bench.node_pids()
    assert len(pids) == len(NODES)
    os.kill(pids[NODES.index(victim)], signal.SIGKILL)
    status, _, err = bench.finish()
    assert status == 1
    assert victim in err
    assert_tidy(bench, tmp_path)


def test_a_frozen_node_is_named_after_the_time_out(running, tmp_path):
    bench = running("--processes", "each", "--timeout", "1")
    os.kill(bench.node_pids()[NODES.index("valve_right")], signal.SIGSTOP)
    status, _, err = bench.finish()
    assert status == 1
    assert "valve_right" in err
    assert "/valve/right/command" in err
    assert_tidy(bench, tmp_path)


@pytest.mark.parametrize(
    ("number", "expected"), [(signal.SIGINT, 130), (signal.SIGTERM, 143)], ids=["SIGINT", "SIGTERM"]
)
def test_a_signal_ends_the_run_in_order(running, number, expected, tmp_path):
    bench = running()
    os.killpg(bench.process.pid, number)
    began = time.monotonic()
    status, said, err = bench.finish()
    assert status == expected, err
    assert time.monotonic() - began < 5.0
    assert re.search(r"broken off after \d+ of \d+ ticks: .*" + number.name, said), said
    assert "in 0.0000 s" not in said
    assert f"stopped by {number.name}" in err
    assert str(BAG) in err
    assert "Traceback" not in err
    assert_tidy(bench, tmp_path)


@pytest.mark.parametrize("delay", [0.2, 0.8, 1.6])
def test_ctrl_c_while_it_starts(delay, tmp_path):
    bench = Bench(*LONG, folder=tmp_path)
    time.sleep(delay)
    os.killpg(bench.process.pid, signal.SIGINT)
    status, _, err = bench.finish()
    assert status in (130, -signal.SIGINT)
    assert "Error" not in err
    wait_for(lambda: not bench.left_over(), 10.0)


def test_a_killed_command_takes_its_nodes_along(running, tmp_path):
    bench = running()
    bench.process.kill()
    bench.finish()
    assert_tidy(bench, tmp_path)


@pytest.mark.parametrize(
    ("fault", "expected"),
    [
        ("out[0] = float('nan')", ["driver", "/driver/torque", "tick 300"]),
        ("raise RuntimeError('hands off')", ["driver", "hands off"]),
    ],
    ids=["nan", "raises"],
)
def test_a_node_of_one_s_own_that_fails_is_named(fault, expected, tmp_path):
    (tmp_path / "bad_driver.py").write_text(BAD_DRIVER.format(fault=fault))
    data = yaml.safe_load(shipped("node set")["closed_centre"].read_text())
    data["nodes"]["driver"]["kind"] = "bad_driver:make"
    (tmp_path / "mine.yaml").write_text(yaml.safe_dump(data, sort_keys=False))
    bench = Bench(*LONG, "--node-set", "mine.yaml", folder=tmp_path, modules=[tmp_path])
    status, _, err = bench.finish()
    assert status == 1
    for part in expected:
        assert part in err
    assert len(read_bag(tmp_path / BAG)["/steering/torque"]) >= 300
    assert_tidy(bench, tmp_path)


def small_files() -> None:
    """Let no file of this process and its children grow beyond 3 MB, as a full disk would."""
    resource.setrlimit(resource.RLIMIT_FSIZE, (3_000_000, 3_000_000))


def test_a_bag_that_cannot_grow_ends_the_run(tmp_path):
    # The kernels are compiled beforehand: their cache may hold larger files.
    assert Bench("run", "step", "--duration", "0.1", folder=tmp_path).finish()[0] == 0
    bench = Bench(*LONG, folder=tmp_path, preexec_fn=small_files)
    status, _, err = bench.finish()
    assert status == 1
    assert "cannot be written on" in err
    assert str(BAG) in err
    assert_tidy(bench, tmp_path)


@pytest.mark.skipif(
    os.getuid() != 0 or not shutil.which("mount"), reason="a small disk needs root and mount"
)
def test_a_full_disk_ends_the_run(tmp_path):
    (tmp_path / "out").mkdir()
    words = ["mount", "-t", "tmpfs", "-o", "size=3m", "tmpfs", str(tmp_path / "out")]
    if subprocess.run(words, capture_output=True, check=False).returncode != 0:
        pytest.skip("mounting is not allowed here")
    try:
        bench = Bench(*LONG, folder=tmp_path)
        status, _, err = bench.finish()
        assert status == 1
        assert "No space left on device" in err
        assert_tidy(bench, tmp_path)
    finally:
        subprocess.run(["umount", str(tmp_path / "out")], check=False)
