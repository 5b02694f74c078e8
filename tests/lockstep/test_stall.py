from steering_lockstep.graph import NodeSpec, check_graph
from steering_lockstep.stall import Report, culprit

GRAPH = check_graph(
    [
        NodeSpec("plant", "plant", {"/c": 0, "/d": 0}, ("/steering/torque", "/clock")),
        NodeSpec("first", "x:y", {"/steering/torque": 0}, ("/a",)),
        NodeSpec("second", "x:y", {"/a": 0}, ("/c",)),
        NodeSpec("other", "x:y", {"/steering/torque": 0}, ("/d",)),
    ]
)


def reports(**changes):
    """A stall at tick 7: the plant lacks /c, since /a never came."""
    table = {
        "plant": Report(7, ("/c",)),
        "first": Report(7, ("/steering/torque",)),
        "second": Report(7, ("/a",)),
        "other": Report(8, ("/steering/torque",)),
    }
    return {k: v for k, v in {**table, **changes}.items() if v is not None}


def test_silent_node_at_the_end_of_the_chain_is_blamed_not_who_waits_for_it():
    found = culprit(reports(first=None), GRAPH)
    assert (found.node, found.topic, found.tick) == ("first", "/a", 7)
    assert "silent" in found.reason


def test_stuck_node_is_blamed():
    found = culprit(reports(first=Report(7, (), busy=True)), GRAPH)
    assert (found.node, found.topic, found.tick) == ("first", "/a", 7)
    assert "step" in found.reason


def test_node_that_has_all_and_publishes_nothing_is_blamed():
    found = culprit(reports(first=Report(7, ())), GRAPH)
    assert found.node == "first"
    assert "lacks nothing" in found.reason


def test_silent_clock_is_blamed_first():
    assert culprit(reports(plant=None), GRAPH).node == "plant"


def test_lost_message_is_told_from_a_late_node():
    found = culprit(reports(first=Report(8, ("/steering/torque",))), GRAPH)
    assert (found.node, found.topic) == ("first", "/a")
    assert "has not arrived" in found.reason


def test_of_two_missing_topics_the_dead_source_is_named():
    plant = Report(7, ("/c", "/d"))
    found = culprit(reports(plant=plant, first=Report(7, ("/steering/torque",)), other=None), GRAPH)
    assert (found.node, found.topic) == ("other", "/d")


def test_lost_measurement_is_blamed_on_the_way_from_the_clock():
    found = culprit(reports(first=Report(7, ("/steering/torque",))), GRAPH)
    assert (found.node, found.topic, found.tick) == ("plant", "/steering/torque", 7)
    assert "has not arrived" in found.reason


def test_waiting_for_each_other_ends():
    waiting = reports(first=Report(7, ("/c",)))
    assert "wait for each other" in culprit(waiting, GRAPH).reason
