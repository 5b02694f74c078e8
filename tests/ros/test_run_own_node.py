"""The guide's controller of one's own runs in the graph."""

import re
from pathlib import Path

import pytest
from bench_process import Bench

from steering_bringup.bags import read_bag
from steering_bringup.shipped import shipped

pytest.importorskip("rclpy")
pytestmark = pytest.mark.ros

GUIDE = Path(__file__).parents[2] / "docs" / "extending.md"


@pytest.fixture
def mine(tmp_path):
    """A node set with the guide's controller on both sides."""
    code = re.findall(r"```python\n(# my_controller.*?)```", GUIDE.read_text(), re.DOTALL)[0]
    (tmp_path / "my_controller.py").write_text(code)
    text = shipped("node set")["closed_centre"].read_text()
    (tmp_path / "mine.yaml").write_text(
        text.replace("kind: valve_controller", "kind: my_controller:make")
    )
    return ["run", "step", "--duration", "0.5", "--node-set", "mine.yaml", "--out", "out"]


def test_it_holds_the_pressure_that_its_force_gives(mine, tmp_path):
    status, _, err = Bench(*mine, folder=tmp_path, modules=[tmp_path]).finish()
    assert status == 0, err
    trace = read_bag(tmp_path / "out" / "closed_centre")
    assert set(trace["/valve/left/command"]["solenoid_force"]) == {20.0}
    # (20 N - 12.5 N preload) on a piston of 1.7 mm: 33 bar without flow
    assert trace["/steering/pressure"]["left"][-1] == pytest.approx(33e5, rel=0.1)


def test_the_direct_runner_refuses_it(mine, tmp_path):
    status, _, err = Bench(*mine, "--direct", folder=tmp_path, modules=[tmp_path]).finish()
    assert status == 1
    assert "no node of kind 'my_controller:make'" in err
