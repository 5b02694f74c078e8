"""What goes wrong in a run ends it with an error that names the culprit."""

import time

import lockstep_dummies as dummies
import pytest

from steering_lockstep.processes import Zygote, run_graph

pytest.importorskip("rclpy")
pytest.importorskip("steering_msgs.msg")
pytestmark = pytest.mark.ros

TOPIC = "/driver/torque"


@pytest.fixture(scope="module")
def zygote():
    with Zygote([dummies.HERE]) as zygote:
        yield zygote


def run(zygote, trouble, layout="each", **more):
    graph = dummies.graph(driver="troubled")
    parameters = {"driver": {"trouble": trouble}}
    began = time.monotonic()
    result = run_graph(
        graph, 500, parameters=parameters, layout=layout, zygote=zygote, timeout=1.0, **more
    )
    assert time.monotonic() - began < 15.0
    assert not result.ok
    return result.error


@pytest.mark.parametrize("layout", ["one", "each"])
def test_hanging_node_is_named_not_those_that_wait_for_it(zygote, layout):
    error = run(zygote, "hang", layout, grace=0.5)
    assert (error.kind, error.node, error.tick) == ("timeout", "driver", 50)
    assert error.topic in (None, TOPIC)
    assert "'driver'" in error.message
    assert "50" in error.message


@pytest.mark.parametrize("layout", ["one", "each"])
def test_output_that_is_not_published_is_named(zygote, layout):
    error = run(zygote, "skip", layout)
    assert (error.kind, error.node, error.topic, error.tick) == ("timeout", "driver", TOPIC, 50)


@pytest.mark.parametrize("layout", ["one", "each"])
def test_nan_names_node_topic_field_and_tick(zygote, layout):
    error = run(zygote, "nan", layout)
    assert (error.kind, error.node, error.topic, error.tick) == ("not_finite", "driver", TOPIC, 50)
    assert "field torque" in error.message


def test_core_that_raises_is_named(zygote):
    error = run(zygote, "raise")
    assert (error.kind, error.node, error.tick) == ("core", "driver", 50)
    assert "made up" in error.message


def test_message_that_comes_twice_is_refused(zygote):
    error = run(zygote, "twice")
    assert (error.kind, error.node, error.topic, error.tick) == ("order", "plant", TOPIC, 50)


def test_message_of_a_wrong_size_is_refused(zygote):
    error = run(zygote, "short")
    assert (error.kind, error.node, error.topic) == ("size", "plant", TOPIC)


def test_node_that_cannot_start_says_why(zygote):
    result = run_graph(dummies.graph(driver="refusing"), 10, layout="each", zygote=zygote)
    assert result.error is not None
    assert (result.error.kind, result.error.node) == ("start", "driver")
    assert "no such spring" in result.error.message


def test_node_that_does_not_come_up_is_named(zygote):
    graph = dummies.graph(driver="endless")
    result = run_graph(graph, 10, layout="each", zygote=zygote, start_timeout=3.0, grace=0.2)
    assert result.error is not None
    assert result.error.kind == "start"
    assert "driver" in result.error.message


def test_domain_in_use_is_refused(zygote):
    from steering_lockstep.domain import claim_domain

    claim = claim_domain()
    result = run_graph(dummies.graph(), 10, domain=claim.number, zygote=zygote)
    claim.release()
    assert result.error is not None
    assert result.error.kind == "start"
    assert str(claim.number) in result.error.message
