"""From a node set and a scenario to the checked graph that runs."""

from __future__ import annotations

from collections.abc import Collection, Iterable, Mapping

from steering_bringup.errors import BenchError
from steering_bringup.replays import REPLAY_KIND
from steering_bringup.schema import NodeSet
from steering_core.naming import unknown
from steering_lockstep.graph import RECORDER_KIND, Graph, GraphError, NodeSpec, check_graph
from steering_lockstep.kinds import location
from steering_lockstep.topics import APPLIED, CREDIT, LOAD_COMMAND, OVERLAY, TABLE

RECORDER = "recorder"


def build_graph(
    node_set: NodeSet,
    delays: Mapping[str, int],
    *,
    truth: bool,
    record: bool,
    replayed: Collection[str] = (),
) -> Graph:
    """Return the graph of a node set with extra ``delays`` ("TOPIC->NODE": ticks).

    ``replayed``: nodes whose place a replaying node takes, with the same connections. Raises
    BenchError naming the node set for whatever cannot run.
    """
    try:
        _check_kinds(node_set)
        _check_replayed(node_set, replayed)
        inputs = _inputs(node_set, delays)
        nodes = [
            NodeSpec(
                name,
                REPLAY_KIND if name in replayed else entry.kind,
                inputs[name],
                entry.outputs + (entry.truth if truth else ()),
                entry.period,
            )
            for name, entry in node_set.nodes.items()
        ]
        _check_topics(nodes)
        _check_load(nodes)
        if node_set.valve_system == "open_centre":
            _check_without_overlay(nodes)
        return check_graph([*nodes, recorder(nodes)] if record else nodes)
    except GraphError as error:
        raise BenchError(f"node set '{node_set.name}': {error}") from None


def recorder(nodes: Iterable[NodeSpec]) -> NodeSpec:
    """Return the recorder of every topic that ``nodes`` publish."""
    topics = [topic for node in nodes for topic in node.outputs]
    return NodeSpec(RECORDER, RECORDER_KIND, dict.fromkeys(topics, 0), (CREDIT,))


def recorded_types(graph: Graph) -> dict[str, str]:
    """Return topic to message type ("package/msg/Name") of all that the graph publishes."""
    topics = [t for node in graph.nodes if node.kind != RECORDER_KIND for t in node.outputs]
    return {topic: TABLE[topic].type_name.replace("/", "/msg/") for topic in topics}


def has_arbiter(graph: Graph) -> bool:
    """Return whether torque overlays are applied in a graph."""
    return APPLIED in graph.publisher


def connections(node_set: NodeSet) -> list[str]:
    """Return the connections of a node set, as "TOPIC->NODE"."""
    return [f"{topic}->{name}" for name, entry in node_set.nodes.items() for topic in entry.inputs]


def connection_delays(graph: Graph) -> dict[str, int]:
    """Return the connections that wait, as "TOPIC->NODE": ticks."""
    return {
        f"{topic}->{node.name}": ticks
        for node in graph.nodes
        for topic, ticks in node.inputs.items()
        if ticks
    }


def _inputs(node_set: NodeSet, delays: Mapping[str, int]) -> dict[str, dict[str, int]]:
    inputs = {name: dict(entry.inputs) for name, entry in node_set.nodes.items()}
    known = connections(node_set)
    for connection, ticks in delays.items():
        if connection not in known:
            raise GraphError(unknown("connection", connection, known))
        topic, name = connection.split("->")
        inputs[name][topic] = ticks
    return inputs


def _check_kinds(node_set: NodeSet) -> None:
    for name, entry in node_set.nodes.items():
        if name == RECORDER:
            raise GraphError(f"a node cannot be called '{RECORDER}': --record adds that one")
        try:
            location(entry.kind)
        except KeyError as error:
            raise GraphError(f"node '{name}': {error.args[0]}") from None


def _check_replayed(node_set: NodeSet, replayed: Iterable[str]) -> None:
    for name in replayed:
        if name not in node_set.nodes:
            raise GraphError(f"--from-bag {name}=...: {unknown('node', name, node_set.nodes)}")


def _check_without_overlay(nodes: Iterable[NodeSpec]) -> None:
    for node in nodes:
        for topic in (*node.inputs, *node.outputs):
            if topic.startswith(OVERLAY):
                raise GraphError(
                    f"node '{node.name}': {topic} needs pressure controllers; an open-centre "
                    "valve is moved by the torsion bar alone and cannot apply a torque overlay"
                )


def _check_load(nodes: Iterable[NodeSpec]) -> None:
    """The plant's load is either the ideal rack force or what the load cylinder makes of it."""
    for node in nodes:
        given = {"/vehicle/rack_force", LOAD_COMMAND} & set(node.inputs)
        if node.kind == "plant" and len(given) != 1:
            raise GraphError(
                f"node '{node.name}' needs either /vehicle/rack_force or {LOAD_COMMAND} as an input"
            )


def _check_topics(nodes: Iterable[NodeSpec]) -> None:
    for node in nodes:
        for topic in (*node.inputs, *node.outputs):
            if topic not in TABLE:
                raise GraphError(f"node '{node.name}': {unknown('topic', topic, TABLE)}")
