"""Nodes started one by one, without a supervisor, make the same bytes."""

import os
import subprocess
import sys

import pytest

from steering_lockstep.domain import claim_domain
from steering_lockstep.graph import GraphError
from steering_lockstep.graph_file import read_graph, write_graph

pytest.importorskip("rclpy")
pytest.importorskip("steering_msgs.msg")
bags = pytest.importorskip("steering_bringup.bags")
from steering_bringup.direct_run import run_direct  # noqa: E402
from steering_bringup.graphs import build_graph  # noqa: E402
from steering_bringup.plans import Manner, make_plan  # noqa: E402
from steering_bringup.scenario_files import load_node_set, load_scenario  # noqa: E402

pytestmark = pytest.mark.ros
TICKS = 200
PROGRAMS = ("driver", "vehicle", "recorder", "plant")


@pytest.fixture
def domain():
    claim = claim_domain()
    yield claim.number
    claim.release()


def start(program, graph, domain, *parameters):
    ros = [word for p in parameters for word in ("-p", p)]
    environment = {
        **os.environ,
        "PYTHONPATH": os.pathsep.join(sys.path),
        "ROS_DOMAIN_ID": str(domain),
    }
    return subprocess.Popen(
        [
            sys.executable,
            "-c",
            f"from steering_lockstep.executables import {program}; {program}()",
            *("--graph", str(graph), "--ticks", str(TICKS), "--ros-args"),
            *(ros or ("-p", "parameter_set:=nominal")),
        ],
        env=environment,
    )


def test_nodes_started_one_by_one_make_the_direct_runners_bytes(tmp_path, domain):
    nodes = load_node_set("open_centre")
    scenario = load_scenario("on_centre").model_copy(
        update={"duration": TICKS * 1e-3, "truth": False}
    )
    direct = make_plan(scenario, nodes, Manner("direct", "one"), tmp_path / "direct")
    run_direct(direct)
    write_graph(build_graph(nodes, {}, truth=False, record=True), tmp_path / "graph.json")
    manoeuvre = scenario.manoeuvre.values()
    parameters = {
        "plant": ["valve_system:=open_centre"],
        "driver": [
            "manoeuvre.kind:=on_centre",
            *(f"manoeuvre.{k}:={v}" for k, v in manoeuvre.items()),
        ],
        "vehicle": ["load.kind:=bicycle"],
        "recorder": [f"path:={tmp_path / 'bag'}"],
    }
    for values in parameters.values():
        values.append("vehicle.speed:=19.444")
    running = [
        start(program, tmp_path / "graph.json", domain, *parameters[program])
        for program in PROGRAMS
    ]
    try:
        assert [process.wait(120.0) for process in running] == [0, 0, 0, 0]
    finally:
        for process in running:
            process.kill()
            process.wait()
    expected, recorded = bags.read_bag(tmp_path / "direct"), bags.read_bag(tmp_path / "bag")
    assert bags.first_difference(expected, recorded) is None


def test_graph_file_is_the_graph(tmp_path):
    graph = build_graph(load_node_set("closed_centre"), {}, truth=True, record=True)
    write_graph(graph, tmp_path / "graph.json")
    assert read_graph(tmp_path / "graph.json") == graph


def test_file_without_a_graph_is_refused(tmp_path):
    (tmp_path / "graph.json").write_text("{}")
    with pytest.raises(GraphError, match=r"graph\.json"):
        read_graph(tmp_path / "graph.json")
