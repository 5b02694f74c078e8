import pytest

from steering_lockstep.graph import GraphError, NodeSpec, check_graph

MEASURED = ("/steering/torque", "/steering/rack", "/clock")


def plant(*inputs, **delays):
    return NodeSpec("plant", "plant", {**dict.fromkeys(inputs, 0), **delays}, MEASURED)


def node(name, inputs, *outputs, period=1):
    return NodeSpec(name, "x:y", inputs, outputs, period)


def test_order_follows_what_nodes_wait_for():
    graph = check_graph(
        [
            node("last", {"/b": 0}, "/c"),
            node("middle", {"/a": 0}, "/b"),
            node("first", {"/steering/torque": 0}, "/a"),
            plant("/c"),
        ]
    )
    assert graph.order == ("first", "middle", "last")
    assert graph.clock.name == "plant"
    assert graph.publisher["/b"] == "middle"
    assert [n.name for n in graph.readers("/b")] == ["last"]


def test_cycle_without_delay_is_named():
    nodes = [
        plant("/b"),
        node("one", {"/b": 0, "/steering/torque": 0}, "/a"),
        node("two", {"/a": 0}, "/b"),
    ]
    with pytest.raises(GraphError, match=r"(one -> two -> one|two -> one -> two)"):
        check_graph(nodes)


def test_delay_breaks_the_cycle():
    nodes = [
        plant("/b"),
        node("one", {"/b": 1, "/steering/torque": 0}, "/a"),
        node("two", {"/a": 0}, "/b"),
    ]
    assert check_graph(nodes).order == ("one", "two")


def test_unknown_topic_names_the_nearest():
    with pytest.raises(GraphError, match="nobody publishes /steering/torq; nearest: /steering/t"):
        check_graph([plant("/a"), node("one", {"/steering/torq": 0}, "/a")])


def test_two_publishers_are_refused():
    one = node("one", {"/steering/torque": 0}, "/a")
    two = node("two", {"/steering/torque": 0}, "/a")
    with pytest.raises(GraphError, match="/a is published by both 'one' and 'two'"):
        check_graph([plant("/a"), one, two])


def test_same_name_twice_is_refused():
    one = node("one", {"/steering/torque": 0}, "/a")
    with pytest.raises(GraphError, match="two nodes are called 'one'"):
        check_graph([plant("/a"), one, one])


@pytest.mark.parametrize("delay", [-1, 0.5, True, None])
def test_delay_is_a_whole_number_of_ticks(delay):
    with pytest.raises(GraphError, match="delay"):
        check_graph([plant("/a"), node("one", {"/steering/torque": delay}, "/a")])


@pytest.mark.parametrize("period", [0, -1, 1.5])
def test_period_is_a_whole_number_of_ticks(period):
    with pytest.raises(GraphError, match="period"):
        check_graph([plant("/a"), node("one", {"/steering/torque": 0}, "/a", period=period)])


def test_there_is_exactly_one_clock():
    with pytest.raises(GraphError, match="there is: none"):
        check_graph([node("one", {}, "/a")])
    other = NodeSpec("other", "plant", {}, ("/clock",))
    with pytest.raises(GraphError, match=r"there is: plant, other"):
        check_graph([plant(), other])


def test_node_that_nobody_waits_for_is_refused():
    nodes = [
        plant("/a"),
        node("one", {"/steering/torque": 0}, "/a"),
        node("idle", {"/steering/rack": 0}, "/b"),
    ]
    with pytest.raises(GraphError, match="'idle'"):
        check_graph(nodes)
