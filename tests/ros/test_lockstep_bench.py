"""The bench itself over DDS: its bag is the direct runner's, byte for byte, in every layout."""

from pathlib import Path
from typing import Any

import pytest

from steering_lockstep.processes import Zygote

pytest.importorskip("rclpy")
pytest.importorskip("steering_msgs.msg")
bags = pytest.importorskip("steering_bringup.bags")
from steering_bringup.direct_run import run_direct  # noqa: E402
from steering_bringup.graph_run import run_through_graph  # noqa: E402
from steering_bringup.plans import Manner, make_plan  # noqa: E402
from steering_bringup.scenario_files import load_node_set, load_scenario  # noqa: E402

pytestmark = pytest.mark.ros
NODE_PACKAGES = ("steering_plant.plant_node", "pressure_control.controller_node")
DELAYS = {"/driver/torque->plant": 1, "/steering/pressure->valve_left": 2}


@pytest.fixture(scope="module")
def zygote():
    with Zygote(NODE_PACKAGES) as zygote:
        yield zygote


def plan_of(folder: Path, node_set: str, runner: Any, processes: Any, delays: dict[str, int]):
    scenario = load_scenario("on_centre").model_copy(
        update={"duration": 0.7, "truth": True, "delays": delays}
    )
    nodes = load_node_set(node_set)
    bag = folder / f"{runner}_{processes}"
    return make_plan(scenario, nodes, Manner(runner, processes), bag)


@pytest.mark.parametrize(
    ("node_set", "delays"),
    [("open_centre", {}), ("closed_centre", {}), ("closed_centre", DELAYS)],
    ids=["open", "closed", "closed_delayed"],
)
def test_graph_and_direct_runner_write_the_same_bytes(zygote, tmp_path, node_set, delays):
    outcome = run_direct(plan_of(tmp_path, node_set, "direct", "one", delays))
    expected = bags.read_bag(outcome.bag)
    assert len(expected.payloads["/truth/plant"]) == 700
    for processes in ("one", "each"):
        plan = plan_of(tmp_path, node_set, "graph", processes, delays)
        outcome = run_through_graph(plan, zygote)
        assert outcome.error is None
        recorded = bags.read_bag(outcome.bag)
        assert bags.first_difference(expected, recorded) is None
