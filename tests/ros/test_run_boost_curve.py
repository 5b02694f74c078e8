"""A measured boost curve travels as numbers to nodes and into the bag; its file is read once."""

import pytest
from bench_process import Bench

from steering_bringup.bags import first_difference, read_bag

pytest.importorskip("rclpy")
pytestmark = pytest.mark.ros

COLUMNS = {
    "torsion_bar_torque_Nm": [-4.0, -2.0, 0.0, 2.0, 4.0],
    "load_pressure_Pa": [-9e6, -8e5, 0.0, 1.2e6, 7e6],
}
ROWS = [",".join(map(str, row)) for row in zip(*COLUMNS.values(), strict=True)]


def steer(folder, *words):
    status, out, err = Bench(*words, folder=folder).finish()
    assert status == 0, err
    return out


def test_a_run_is_repeated_after_its_curves_file_is_gone(tmp_path):
    """The bag once held the file's name only, and so did the nodes' parameters."""
    file = tmp_path / "curve.csv"
    file.write_text("\n".join([",".join(COLUMNS), *ROWS]) + "\n")
    words = ("run", "step", "--node-set", "closed_centre", "--duration", "1")
    steer(tmp_path, *words, "--processes", "each", "--set", "boost_curve=curve.csv", "--out", "a")
    steer(tmp_path, *words, "--direct", "--out", "formula")
    file.unlink()
    bag = tmp_path / "a" / "closed_centre"
    recorded = read_bag(bag)
    assert recorded.run["scenario"]["boost_curve"] == COLUMNS
    assert "bit for bit" in steer(tmp_path, "repeat", str(bag), "--direct")
    assert first_difference(recorded, read_bag(tmp_path / "formula" / "closed_centre")) is not None
