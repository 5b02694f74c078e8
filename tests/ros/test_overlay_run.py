"""Torque overlays in the real graph: the same bytes as without ROS, and guests from outside."""

import os
import re
import subprocess
import sys
import time
from pathlib import Path

import numpy as np
import pytest
from bench_process import Bench, wait_for

from steering_bringup.bags import first_difference, read_bag
from steering_bringup.shipped import shipped

pytest.importorskip("rclpy")
pytestmark = pytest.mark.ros

NAME = "closed_centre_lane_keeping"
DELAYS = ("--delay", "/torque_overlay/lane_keeper->arbiter=4", "--delay",
          "/torque_overlay/applied->valve_left=1")  # fmt: skip


def run(folder, *words):
    folder.mkdir()
    status, out, err = Bench("run", "lane_keeping", *words, "--out", "out", folder=folder).finish()
    assert status == 0, err
    assert " 0 lost" in out
    return read_bag(folder / "out" / NAME)


@pytest.mark.parametrize("delays", [(), DELAYS], ids=["at once", "delayed"])
def test_graph_and_direct_runner_leave_the_same_bytes(tmp_path, delays):
    words = ("--duration", "5", *delays)
    direct = run(tmp_path / "direct", *words, "--direct")
    assert np.max(np.abs(direct["/torque_overlay/applied"]["applied"])) > 3.0
    assert len(direct["/torque_overlay/lane_keeper"]) == 500
    one = run(tmp_path / "one", *words)
    assert first_difference(direct, one) is None
    if not delays:
        each = run(tmp_path / "each", *words, "--processes", "each")
        assert first_difference(direct, each) is None


def test_what_was_applied_can_be_read_with_its_reasons(tmp_path):
    trace = run(tmp_path / "one", "--duration", "5", "--set", "overlay.maximum_torque=2")
    applied = trace["/torque_overlay/applied"]
    assert np.max(np.abs(applied["applied"])) == 2.0
    limited = applied["limited_torque"].astype(bool)
    assert limited.any()
    assert np.all(np.abs(applied["asked"][limited]) > 2.0)
    assert set(applied["source"]) == {0, 1} or set(applied["source"]) == {1}


GUIDE = Path(__file__).parents[2] / "docs" / "overlay_node.md"


def from_guide(name, folder):
    """Save a program of the guide."""
    code = re.findall(rf"```python\n(# {name}\n.*?)```", GUIDE.read_text(), re.DOTALL)[0]
    (folder / name).write_text(code)
    return folder / name


def test_the_guides_guest_steers_from_another_process_and_is_faded_out(tmp_path):
    program = from_guide("pull_left.py", tmp_path)
    environment = {**os.environ, "ROS_DOMAIN_ID": "77"}
    words = ("--node-set", "closed_centre_overlay", "--real-time", "--domain", "77")
    bench = Bench("run", "lane_keeping", *words, "--duration", "8", "--out", "out", folder=tmp_path)
    words = (sys.executable, "-m", "steering_bringup.cli", "python", str(program))
    guest = subprocess.Popen(words, env=environment)
    try:
        wait_for((tmp_path / "out" / "closed_centre_overlay").exists)
        time.sleep(6.0)
    finally:
        guest.kill()
        guest.wait()
    status, _, err = bench.finish()
    assert status == 0, err
    applied = read_bag(tmp_path / "out" / "closed_centre_overlay")["/torque_overlay/applied"]
    assert np.max(applied["applied"]) == 2.0
    assert set(applied["source"]) == {0, 1}
    assert np.max(np.abs(np.diff(applied["applied"]))) < 0.03


def test_the_guides_member_runs_in_lock_step(tmp_path):
    from_guide("my_keeper.py", tmp_path)
    text = shipped("node set")["closed_centre_lane_keeping"].read_text()
    (tmp_path / "mine.yaml").write_text(text.replace("kind: lane_keeper", "kind: my_keeper:make"))
    words = ("run", "lane_keeping", "--node-set", "mine.yaml", "--duration", "2", "--out", "out")
    status, _, err = Bench(*words, folder=tmp_path).finish()
    assert status == 0, err
    trace = read_bag(tmp_path / "out" / "closed_centre_lane_keeping")
    assert set(trace["/torque_overlay/applied"]["source"]) == {1}
