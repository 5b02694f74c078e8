"""Which node of a run with a rig is in which process: only nodes of the bench beside the bridge."""

from steering_bringup.rig_runs import rig_layout
from steering_lockstep.graph import CREDIT, NodeSpec, check_graph


def test_a_node_of_one_s_own_and_the_recorder_cannot_stop_the_bridge():
    graph = check_graph(
        [
            NodeSpec("plant", "rig_bridge", {"/a": 0, "/b": 0, "/c": 0}, ("/m", "/clock")),
            NodeSpec("left", "valve_controller", {"/m": 0}, ("/a",)),
            NodeSpec("driver", "replay", {"/m": 0}, ("/b",)),
            NodeSpec("mine", "my_module:make", {"/m": 0}, ("/c",)),
            NodeSpec("recorder", "recorder", {"/m": 0}, (CREDIT,)),
        ]
    )
    assert rig_layout(graph) == {
        "plant": "rig",
        "left": "rig",
        "driver": "rig",
        "mine": "nodes",
        "recorder": "recorder",
    }
