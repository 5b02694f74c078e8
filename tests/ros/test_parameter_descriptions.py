"""What `ros2 param describe` shows: the meaning, the unit at the end, that it cannot be changed."""

from typing import Any

import pytest

from steering_bringup.graphs import build_graph
from steering_bringup.scenario_files import load_node_set
from steering_core.parameters import load_parameters
from steering_lockstep.kinds import factory
from steering_lockstep.settings import RunSettings

rclpy = pytest.importorskip("rclpy")
pytest.importorskip("steering_msgs.msg")
from rclpy.context import Context  # noqa: E402
from rclpy.parameter import Parameter  # noqa: E402

from steering_lockstep.domain import claim_domain  # noqa: E402

pytestmark = pytest.mark.ros
GRAPH = build_graph(load_node_set("closed_centre"), {}, truth=False, record=False)
OWN: dict[str, dict[str, Any]] = {
    "plant": {"effects.entrained_air.air_fraction": 0.01},
    "valve_left": {"side": "left"},
    "vehicle": {"effects.tyre_relaxation.relaxation_length": 0.4},
}


@pytest.fixture(params=["plant", "valve_left", "driver", "vehicle"])
def node(request):
    claim, context = claim_domain(), Context()
    rclpy.init(context=context, domain_id=claim.number)
    spec = GRAPH.node(request.param)
    values = {**load_parameters().flat(), **OWN.get(request.param, {})}
    made = factory(spec.kind)(context, spec, RunSettings(GRAPH, 10), values)
    yield made
    made.destroy_node()
    context.shutdown()
    claim.release()


def test_every_parameter_of_the_data_sheet_ends_with_its_unit(node):
    sheet = load_parameters()
    for name in sheet:
        text = node.describe_parameter(name).description
        assert text.endswith(f" [{sheet.info(name).unit}]"), name


def test_an_effects_parameter_ends_with_its_unit(node):
    units = {"air_fraction": "1", "relaxation_length": "m"}
    for name in node.values():
        if name.startswith("effects."):
            unit = units[name.rpartition(".")[2]]
            assert node.describe_parameter(name).description.endswith(f" [{unit}]")


def test_a_parameter_cannot_be_changed_in_mid_run(node):
    """The core was built from it: a change would be believed and have no effect."""
    (answer,) = node.set_parameters([Parameter("mechanics.rack_mass", value=3.0)])
    assert not answer.successful
    assert node.values()["mechanics.rack_mass"] == load_parameters()["mechanics.rack_mass"]
