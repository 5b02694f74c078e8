"""Measured files and bags of other tools, compared with runs and with each other."""

import json
from pathlib import Path

import numpy as np
import pytest
from mdf_files import signal, written
from rosbags.rosbag2 import StoragePlugin, Writer
from rosbags.typesys import Stores, get_typestore

from steering_bringup.bags import BagError, Trace
from steering_bringup.cli import main
from steering_bringup.comparison import compare, summary, verdict, write_page
from steering_core.errors import BenchError
from steering_diagnosis.data.compared import trace_of

MAPPING = """\
schema: 1
valve_system: open_centre
time: t
channels:
  steering_wheel_angle: {from: angle, unit: deg}
  left_pressure: {from: pL, unit: bar}
"""


def mapping(folder: Path, text: str = MAPPING, name: str = "mapping.yaml") -> Path:
    path = folder / name
    path.write_text(text)
    return path


def csv(folder: Path, trace: Trace, bar: float = 0.0, name: str = "drive.csv") -> Path:
    """A run's angle and left pressure as a file, `bar` higher."""
    ticks = trace["/steering/torque"]["tick"]
    columns = (
        ticks * 1e-3,
        np.degrees(trace["/steering/torque"]["steering_wheel_angle"]),
        trace["/steering/pressure"]["left"] * 1e-5 + bar,
    )
    path = folder / name
    lines = [",".join(f"{v:.9g}" for v in row) for row in zip(*columns, strict=True)]
    path.write_text("t,angle,pL\n" + "\n".join(lines) + "\n")
    return path


def floats(
    folder: Path, topics: dict[str, np.ndarray], period_ns: int, begin: int = 10**18
) -> Path:
    """A SQLite bag of another tool: Float64 on each topic, no tick."""
    store = get_typestore(Stores.ROS2_JAZZY)
    kind = store.types["std_msgs/msg/Float64"]
    with Writer(folder, version=9, storage_plugin=StoragePlugin.SQLITE3) as writer:
        for topic, values in topics.items():
            connection = writer.add_connection(topic, "std_msgs/msg/Float64", typestore=store)
            for k, value in enumerate(values):
                data = store.serialize_cdr(kind(data=float(value)), "std_msgs/msg/Float64")
                writer.write(connection, begin + k * period_ns, data)
    return folder


def test_a_mapped_file_against_a_run(make_run, tmp_path):
    run = make_run("run", duration=3.0)
    measured = trace_of(csv(tmp_path, run, bar=0.5), mapping(tmp_path))
    result = compare(run, measured)
    assert set(result.differences) == {"left_pressure", "steering_wheel_angle"}
    assert result.differences["left_pressure"].mean == pytest.approx(0.5e5, rel=1e-6)
    assert result.differences["steering_wheel_angle"].largest < 1e-8
    assert result.names == ("run", "drive.csv")
    assert not result.identical
    assert verdict(result).good is None
    assert any("drive.csv does not hold: steering wheel torque" in n for n in result.notes)
    assert "left chamber by at most 0.50 bar" in verdict(result).sentence
    assert verdict(result).sentence.startswith("drive.csv against run")
    text = write_page(result, tmp_path / "page.html").read_text("utf-8")
    assert "Left chamber" in text
    assert max(len(line) for line in summary(result).splitlines()[:4]) <= 100


def test_a_file_given_twice_differs_by_nothing_and_is_no_run(make_run, tmp_path):
    path = csv(tmp_path, make_run("run", duration=3.0))
    first, second = (trace_of(path, mapping(tmp_path)) for _ in range(2))
    result = compare(first, second)
    assert all(item.largest == 0.0 for item in result.differences.values())
    assert not result.identical
    assert result.names == (
        f"{tmp_path.name}/drive.csv (first)",
        f"{tmp_path.name}/drive.csv (second)",
    )


def test_mdf_against_csv_with_a_mapping_each(make_run, tmp_path):
    run = make_run("run", duration=3.0)
    seconds = run["/steering/torque"]["tick"] * 1e-3
    force = 100.0 * np.sin(seconds)
    mf4 = written(
        tmp_path,
        [
            signal(run["/steering/torque"]["steering_wheel_angle"], "a", "rad", seconds),
            signal(force, "F", "N", seconds),
        ],
    )
    other = mapping(
        tmp_path,
        "schema: 1\nvalve_system: closed_centre\nchannels:\n"
        "  steering_wheel_angle: {from: a}\n  rack_force: {from: F}\n",
        "b.yaml",
    )
    out = tmp_path / "out"
    words = ["compare", str(csv(tmp_path, run)), str(mf4), "--mapping", str(mapping(tmp_path))]
    numbers = tmp_path / "numbers.json"
    assert main([*words, "--mapping-b", str(other), "--out", str(out), "--json", str(numbers)]) == 0
    data = json.loads(numbers.read_text())
    assert list(data["differences"]) == ["steering_wheel_angle"]
    assert data["differences"]["steering_wheel_angle"]["largest"] < 1e-8
    assert [item["system"] for item in data["runs"]] == ["open-centre", "closed-centre"]
    notes = " ".join(data["notes"])
    assert "drive.csv does not hold: rack force" in notes
    assert "drive.mf4 does not hold: left chamber" in notes
    assert (out / "comparison.html").is_file()


def test_measured_data_share_more_than_a_run_shows(tmp_path):
    seconds = np.arange(0.0, 3.0, 1e-3)
    text = "schema: 1\nvalve_system: open_centre\nchannels:\n  rack_force: {from: F}\n"
    traces = []
    for name, force in (("a.mf4", 100.0), ("b.mf4", 130.0)):
        values = force * np.sin(4 * seconds)
        values[1000:1100] = np.nan if name == "a.mf4" else values[1000:1100]
        path = written(tmp_path, [signal(values, "F", "N", seconds)], name=name)
        traces.append(trace_of(path, mapping(tmp_path, text)))
    result = compare(*traces)
    there = np.abs(np.sin(4 * seconds))[np.r_[:1000, 1100:3000]]
    assert result.differences["rack_force"].largest == pytest.approx(30.0 * there.max(), rel=1e-6)
    assert len(result.time) == pytest.approx(2900, abs=3)
    assert "rack force by at most 30.0 N" in verdict(result).sentence
    assert "Rack force" in write_page(result, tmp_path / "page.html").read_text("utf-8")


def test_bags_of_another_tool_share_what_they_share(tmp_path):
    """Other clocks, other rates: by the time since each bag's beginning, on the bench's grid."""
    fast, slow = np.arange(0.0, 4.0, 1e-3), np.arange(0.0, 4.0, 2e-3)
    wave = lambda t: 2.0 * np.sin(2 * np.pi * 0.5 * t)  # noqa: E731
    a = floats(tmp_path / "a", {"/wheel/speed": wave(fast), "/only_a": fast}, 10**6)
    b = floats(
        tmp_path / "b", {"/wheel/speed": wave(slow) + 0.25, "/short": slow[:5]}, 2 * 10**6, 7
    )
    result = compare(trace_of(a, None), trace_of(b, None))
    assert list(result.differences) == ["/wheel/speed data"]
    item = result.differences["/wheel/speed data"]
    assert item.mean == pytest.approx(0.25, abs=1e-4)
    # A straight line between samples 2 ms apart leaves at most w^2 h^2 / 8 of the amplitude.
    assert abs(item.largest - 0.25) < 2.0 * (np.pi * 2e-3) ** 2 / 8
    notes = " ".join(result.notes)
    assert "b does not hold: /only_a data" in notes
    assert "left out: /short data: 5 samples are too few" in notes
    assert "by their time from the bag's beginning" in notes
    assert result.systems == ("", "")
    page = write_page(result, tmp_path / "page.html").read_text("utf-8")
    assert "/wheel/speed data" in page
    assert "Nothing that differs is recorded about how they were made." in page
    assert "nothing is filtered or resampled" not in page
    json.dumps(result.to_dict(), allow_nan=False)


def test_nothing_shared_is_one_line(make_run, tmp_path, capsys):
    run = make_run("run", duration=3.0)
    bag = floats(tmp_path / "a", {"/only_a": np.arange(300.0)}, 10**6)
    with pytest.raises(BagError, match="run and a share no signal to compare"):
        compare(run, trace_of(bag, None))
    assert main(["compare", str(run.path), str(bag), "--out", str(tmp_path / "out")]) == 1
    assert capsys.readouterr().err.count("\n") == 1


def test_a_file_needs_its_mapping(make_run, tmp_path):
    path = csv(tmp_path, make_run("run", duration=3.0))
    with pytest.raises(BenchError, match="needs a mapping file"):
        trace_of(path, None)
    with pytest.raises(BenchError, match="no bag"):
        trace_of(tmp_path / "nothing", None)


def test_runs_are_compared_as_before(pair):
    """Both ways to a run's trace give the same page's numbers."""
    result = compare(*(trace_of(trace.path, None) for trace in pair))
    assert result.to_dict() == compare(*pair).to_dict()
    assert list(result.differences) == [
        "steering_wheel_torque",
        "torsion_bar_torque",
        "assistance_pressure",
        "left_pressure",
        "right_pressure",
        "supply_pressure",
        "steering_wheel_angle",
        "steering_wheel_speed",
        "rack_position",
    ]


@pytest.mark.parametrize("how", ["cut off", "without its metadata", "complete"])
def test_a_comparison_changes_nothing_of_its_inputs(how, make_run, tmp_path):
    first, second = (make_run(name, duration=3.0).path for name in ("first", "second"))
    file = next(second.glob("*.mcap"))
    if how == "cut off":
        with file.open("r+b") as opened:
            opened.truncate(file.stat().st_size * 2 // 3)
    if how != "complete":
        (second / "metadata.yaml").unlink()
    before = {path: path.read_bytes() for path in second.rglob("*") if path.is_file()}
    assert main(["compare", str(first), str(second), "--out", str(tmp_path / "page")]) == 0
    assert {path: path.read_bytes() for path in second.rglob("*") if path.is_file()} == before
    told = [note for note in trace_of(second, None).notes if "steer recover" in note]
    assert bool(told) == (how != "complete")
