"""Hardware as the clock: the same bits whether messages are handed over by a call or over DDS."""

import lockstep_dummies as dummies
import pytest

from steering_lockstep.processes import Zygote, run_graph

pytest.importorskip("rclpy")
pytest.importorskip("steering_msgs.msg")
pytestmark = pytest.mark.ros

bags = pytest.importorskip("steering_bringup.bags")
TICKS = 300
APART = {"recorder": "recorder"}
LAYOUTS = {
    "one": "one",
    "each": "each",
    "recorder apart": APART,
    "clock apart": {**APART, "plant": "rig"},
    "a node apart": {**APART, "left": "own"},
}
DELAYED = {
    ("/steering/torque", "left"): 1,
    ("/valve/right/command", "plant"): 2,
    ("/vehicle/rack_force", "plant"): 7,
    ("/steering/torque", "driver"): 3,
}
WAYS = {"plain": ({}, {}), "delayed": (DELAYED, {}), "slow": (DELAYED, {"driver": 10, "right": 3})}


@pytest.fixture(scope="module")
def zygote():
    with Zygote([dummies.HERE, "steering_bringup.recorder_node"]) as zygote:
        yield zygote


def run(zygote, delays, periods, layout, path, clock="rig"):
    graph = dummies.graph(delays, periods, recorder="recorder", clock=clock)
    parameters = {"recorder": {"path": str(path)}}
    return graph, run_graph(
        graph, TICKS, parameters=parameters, layout=layout, urgent=True, zygote=zygote
    )


@pytest.mark.parametrize("way", WAYS)
def test_every_layout_gives_the_same_bytes_on_every_topic(zygote, way, tmp_path):
    first = None
    for name, layout in LAYOUTS.items():
        graph, result = run(zygote, *WAYS[way], layout, tmp_path / name)
        assert result.ok, (name, result.error)
        assert not any(result.lost.values())
        digests = {n: v["digest"] for n, v in result.node_results.items() if "digest" in v}
        assert digests.items() <= dummies.reference(graph, TICKS).items(), name
        assert len(digests) == 5
        bag = bags.read_bag(tmp_path / name)
        assert sorted(bag.payloads) == sorted(set(graph.publisher) - {"/recorder/credit"})
        first = first or bag
        assert bags.first_difference(first, bag) is None, name


@pytest.mark.parametrize("layout", ["one", "each"])
def test_periods_that_come_together_are_answered_one_by_one(zygote, layout, tmp_path):
    _, result = run(zygote, {}, {}, layout, tmp_path / "bag", "piled_rig")
    assert result.ok, result.error
    expected = [(tick, 2 - tick % 3) for tick in range(TICKS)]
    assert [tuple(each) for each in result.node_results["plant"]["answers"]] == expected
