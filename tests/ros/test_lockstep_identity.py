"""The lock-step contract over real DDS: the same bits in every layout, and as without ROS."""

import lockstep_dummies as dummies
import pytest

from steering_lockstep.processes import Progress, Zygote, run_graph

pytest.importorskip("rclpy")
pytest.importorskip("steering_msgs.msg")
pytestmark = pytest.mark.ros

TICKS = 300
LAYOUTS = ["one", "each", {"left": "a", "right": "a", "driver": "b"}]
DELAYED = {
    ("/steering/torque", "left"): 1,
    ("/valve/right/command", "plant"): 2,
    ("/vehicle/rack_force", "plant"): 7,
}


@pytest.fixture(scope="module")
def zygote():
    with Zygote([dummies.HERE]) as zygote:
        yield zygote


def digests(result):
    return {name: values["digest"] for name, values in result.node_results.items()}


@pytest.mark.parametrize("layout", LAYOUTS, ids=["one", "each", "mixed"])
@pytest.mark.parametrize(
    ("delays", "periods"),
    [({}, {}), (DELAYED, {}), ({}, {"driver": 10, "right": 3}), (DELAYED, {"left": 4})],
    ids=["plain", "delays", "periods", "both"],
)
def test_every_layout_gives_the_bits_of_a_plain_loop(zygote, layout, delays, periods):
    graph = dummies.graph(delays, periods)
    result = run_graph(graph, TICKS, layout=layout, zygote=zygote)
    assert result.ok, result.error
    assert result.ticks == TICKS
    assert digests(result) == dummies.reference(graph, TICKS)


def test_every_output_is_published_once_on_each_of_its_ticks(zygote):
    result = run_graph(dummies.graph({}, {"driver": 10}), TICKS, zygote=zygote)
    assert result.counts["plant"] == dict.fromkeys((*dummies.MEASURED, "/clock"), TICKS)
    assert result.counts["driver"] == {"/driver/torque": TICKS // 10}
    assert not any(result.lost.values())


def test_rest_values_stand_for_messages_before_the_first(zygote):
    graph = dummies.graph(DELAYED)
    rest = {"/vehicle/rack_force": (1.0, 2.0, 3.0)}
    plain = digests(run_graph(graph, 20, zygote=zygote))
    rested = digests(run_graph(graph, 20, rest=rest, zygote=zygote))
    assert plain["plant"] != rested["plant"]


def test_progress_tells_phases_and_ticks(zygote):
    told: list[Progress] = []
    result = run_graph(dummies.graph(), 3000, on_progress=told.append, zygote=zygote)
    assert result.ok
    phases = list(dict.fromkeys(p.phase for p in told))
    assert phases == ["starting", "matching", "running", "closing"] or phases == [
        "starting",
        "running",
        "closing",
    ]
    assert [p.tick for p in told] == sorted(p.tick for p in told)
    assert 0.0 < result.first_tick_time < 60.0
    assert result.wall_time > 0.0
    assert result.real_time_factor == pytest.approx(3.0 / result.wall_time)


def test_real_time_keeps_to_the_wall_clock(zygote):
    result = run_graph(dummies.graph(), 500, real_time=True, zygote=zygote)
    assert result.ok
    assert result.wall_time >= 0.499
    assert result.latency is not None
    assert result.latency["ticks"] == 500
    assert 0.0 < result.latency["p50"] <= result.latency["p99"] <= result.latency["max"]
    assert digests(result) == dummies.reference(dummies.graph(), 500)


def test_diagnostics_tell_changes_and_once_a_second(zygote):
    result = run_graph(dummies.graph(driver="listener"), TICKS, zygote=zygote)
    assert result.ok, result.error
    told = result.node_results["driver"]["told"]
    assert told[0] == ("running", 0)
    assert len(told) <= 2 + result.wall_time
