"""The recorder: published bytes, nothing lost, the trace unchanged, the loop held when it lags."""

import json
import time

import lockstep_dummies as dummies
import numpy as np
import pytest

from steering_lockstep.processes import Zygote, run_graph
from steering_lockstep.settings import CREDIT_TICKS

pytest.importorskip("rclpy")
pytest.importorskip("steering_msgs.msg")
pytestmark = pytest.mark.ros

bags = pytest.importorskip("steering_bringup.bags")
TICKS = 1234


@pytest.fixture(scope="module")
def zygote():
    with Zygote([dummies.HERE, "steering_bringup.recorder_node"]) as zygote:
        yield zygote


def record(zygote, path, ticks=TICKS, kind="recorder", layout="one", **more):
    graph = dummies.graph(driver="troubled", recorder=kind)
    metadata = json.dumps({"scenario": {"name": "made up"}})
    parameters = {
        "recorder": {"path": str(path), "metadata": metadata},
        "driver": {"trouble": more.pop("trouble", "none")},
    }
    return run_graph(graph, ticks, parameters=parameters, layout=layout, zygote=zygote, **more)


@pytest.mark.parametrize("layout", ["one", "each", {"recorder": "recorder"}])
def test_every_topic_is_complete_and_the_trace_is_unchanged(zygote, tmp_path, layout):
    result = record(zygote, tmp_path / "bag", layout=layout)
    assert result.ok, result.error
    assert not any(result.lost.values())
    trace = bags.read_bag(tmp_path / "bag")
    names = [n for counts in result.counts.values() for n in counts if n != "/recorder/credit"]
    assert sorted(trace.payloads) == sorted(names)
    assert {len(rows) for rows in trace.payloads.values()} == {TICKS}
    plain = run_graph(
        dummies.graph(driver="troubled"),
        TICKS,
        parameters={"driver": {"trouble": "none"}},
        zygote=zygote,
    )
    for name, values in plain.node_results.items():
        assert result.node_results[name]["digest"] == values["digest"]


def test_same_bytes_in_every_layout(zygote, tmp_path):
    for layout in ("one", "each"):
        assert record(zygote, tmp_path / layout, layout=layout).ok
    one, each = (bags.read_bag(tmp_path / layout) for layout in ("one", "each"))
    assert bags.first_difference(one, each) is None


@pytest.mark.parametrize("layout", ["one", "each"])
def test_slow_recorder_holds_the_loop_and_loses_nothing(zygote, tmp_path, layout):
    ticks = 3 * CREDIT_TICKS
    result = record(zygote, tmp_path / "bag", ticks, f"{dummies.HERE}:slow_recorder", layout)
    assert result.ok, result.error
    # It sleeps 0.05 s for every 100 ticks; without the credit the loop would be far ahead of it.
    assert result.wall_time > 0.05 * (ticks - CREDIT_TICKS) / 100 * 0.9
    trace = bags.read_bag(tmp_path / "bag")
    assert {len(rows) for rows in trace.payloads.values()} == {ticks}


def test_failed_run_leaves_a_bag_up_to_the_failure(zygote, tmp_path):
    result = record(zygote, tmp_path / "bag", layout="each", trouble="raise")
    assert result.error is not None
    assert result.error.kind == "core"
    trace = bags.read_bag(tmp_path / "bag")
    assert len(trace.payloads["/steering/torque"]) == 51
    assert len(trace.payloads["/driver/torque"]) == 50


def test_bag_that_is_there_is_not_overwritten(zygote, tmp_path):
    (tmp_path / "bag").mkdir()
    (tmp_path / "bag" / "precious").write_text("data")
    result = record(zygote, tmp_path / "bag")
    assert result.error is not None
    assert (result.error.kind, result.error.node) == ("start", "recorder")
    assert (tmp_path / "bag" / "precious").read_text() == "data"


def test_full_disk_ends_the_run_with_a_clear_error(zygote, tmp_path):
    began = time.monotonic()
    result = record(zygote, tmp_path / "bag", 100_000, f"{dummies.HERE}:full_disk", "each")
    assert time.monotonic() - began < 20.0
    assert result.error is not None
    assert (result.error.kind, result.error.node) == ("record", "recorder")
    assert "No space left" in result.error.message


def test_stamps_are_the_ticks(zygote, tmp_path):
    assert record(zygote, tmp_path / "bag", 150).ok
    trace = bags.read_bag(tmp_path / "bag")
    torque = trace.payloads["/steering/torque"].view()
    seconds = torque[:, 4:8].copy().view("<i4").ravel()
    nanoseconds = torque[:, 8:12].copy().view("<u4").ravel()
    assert np.array_equal(seconds * 1000 + nanoseconds // 1_000_000, np.arange(150))
