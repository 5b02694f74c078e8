"""The node set as a checked graph: who publishes what, in which order, with which delays.

Pure: plain dataclasses and functions on them, no ROS. The launcher builds ``NodeSpec`` objects
from a node set file; everything that runs (graph or direct runner) starts from ``check_graph``.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field
from difflib import get_close_matches

RECORDER_KIND = "recorder"
CLOCK = "/clock"
CREDIT = "/recorder/credit"
"""Published by a recorder: the clock waits when it lags too far behind."""


class GraphError(ValueError):
    """The node set is no graph that can run in lock step."""


@dataclass(frozen=True)
class NodeSpec:
    """One node of a node set.

    ``inputs`` maps each topic to its delay in ticks, in the order in which the core takes them.
    ``outputs`` are published in this order, once on each of the node's ticks (0, period, ...).
    ``kind`` names the program: a key of ``steering_lockstep.kinds.FACTORIES`` or "module:function".
    """

    name: str
    kind: str
    inputs: Mapping[str, int] = field(default_factory=dict)
    outputs: tuple[str, ...] = ()
    period: int = 1


@dataclass(frozen=True)
class Graph:
    """A checked node set. ``order``: nodes after the clock in an order that needs no future."""

    nodes: tuple[NodeSpec, ...]
    clock: NodeSpec
    order: tuple[str, ...]
    publisher: Mapping[str, str]

    def node(self, name: str) -> NodeSpec:
        """Return the node called ``name``."""
        return next(n for n in self.nodes if n.name == name)

    def readers(self, topic: str) -> tuple[NodeSpec, ...]:
        """Return the nodes that take ``topic`` as an input."""
        return tuple(n for n in self.nodes if topic in n.inputs)


def check_graph(nodes: Iterable[NodeSpec]) -> Graph:
    """Return the checked graph of ``nodes``.

    Raises ``GraphError`` when there is not exactly one clock (plant), a name or a topic's
    publisher is not unique, an input has no publisher (the nearest topic is named), a delay or
    period is no whole number of ticks, a node gives nothing that the clock waits for (it could
    fall behind without bound), or nodes wait for each other within one tick (the cycle is named).
    """
    nodes = tuple(nodes)
    _check_names(nodes)
    clock = _the_clock(nodes)
    publisher = _publishers(nodes)
    _check_inputs(nodes, publisher)
    _check_feeds_clock(nodes, clock, publisher)
    return Graph(nodes, clock, _order(nodes, clock, publisher), publisher)


def _check_names(nodes: tuple[NodeSpec, ...]) -> None:
    seen: set[str] = set()
    for node in nodes:
        if node.name in seen:
            raise GraphError(f"two nodes are called '{node.name}'")
        seen.add(node.name)
        if not isinstance(node.period, int) or node.period < 1:
            raise GraphError(f"node '{node.name}': period {node.period!r} is no whole tick count")


def _the_clock(nodes: tuple[NodeSpec, ...]) -> NodeSpec:
    clocks = [n for n in nodes if CLOCK in n.outputs]
    if len(clocks) != 1:
        names = ", ".join(n.name for n in clocks) or "none"
        raise GraphError(f"exactly one node must publish /clock; there is: {names}")
    if clocks[0].period != 1:
        raise GraphError(f"node '{clocks[0].name}' is the clock; its period must be 1")
    return clocks[0]


def _publishers(nodes: tuple[NodeSpec, ...]) -> dict[str, str]:
    publisher: dict[str, str] = {}
    for node in nodes:
        for topic in node.outputs:
            if topic in publisher:
                raise GraphError(
                    f"{topic} is published by both '{publisher[topic]}' and '{node.name}'"
                )
            publisher[topic] = node.name
    return publisher


def _check_inputs(nodes: tuple[NodeSpec, ...], publisher: Mapping[str, str]) -> None:
    for node in nodes:
        for topic, delay in node.inputs.items():
            if topic not in publisher:
                near = get_close_matches(topic, publisher, n=1, cutoff=0.0)
                hint = f"; nearest: {near[0]}" if near else ""
                raise GraphError(f"node '{node.name}': nobody publishes {topic}{hint}")
            if not isinstance(delay, int) or isinstance(delay, bool) or delay < 0:
                raise GraphError(
                    f"node '{node.name}': delay {delay!r} of {topic} is no whole tick count"
                )


def _check_feeds_clock(
    nodes: tuple[NodeSpec, ...], clock: NodeSpec, publisher: Mapping[str, str]
) -> None:
    by_name = {node.name: node for node in nodes}
    feeding, todo = {clock.name}, [clock]
    while todo:
        sources = {publisher[topic] for topic in todo.pop().inputs} - feeding
        feeding |= sources
        todo += [by_name[name] for name in sources]
    for node in nodes:
        if node.name not in feeding and CREDIT not in node.outputs:
            raise GraphError(f"node '{node.name}' gives nothing that the clock waits for")


def _order(
    nodes: tuple[NodeSpec, ...], clock: NodeSpec, publisher: Mapping[str, str]
) -> tuple[str, ...]:
    """Sort the nodes other than the clock so that each comes after what it waits for.

    The clock publishes at the start of a tick from its state, so nobody waits for a cycle
    through it; every other input without delay is an edge.
    """
    waits = {
        n.name: [publisher[t] for t, d in n.inputs.items() if d == 0 and publisher[t] != clock.name]
        for n in nodes
        if n.name != clock.name
    }
    done: list[str] = []
    trail: list[str] = []

    def visit(name: str) -> None:
        if name in done:
            return
        if name in trail:
            cycle = " -> ".join([*reversed(trail[trail.index(name) :]), trail[-1]])
            raise GraphError(f"cycle without delay: {cycle}; give one of its inputs a delay")
        trail.append(name)
        for other in waits[name]:
            visit(other)
        trail.pop()
        done.append(name)

    for name in waits:
        visit(name)
    return tuple(done)
