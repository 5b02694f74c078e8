"""Which numbers of which messages a core takes and gives, whatever the node set's order. Pure."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from operator import itemgetter
from typing import Any

from steering_lockstep.graph import GraphError, NodeSpec
from steering_lockstep.topics import topic, wire


@dataclass(frozen=True)
class Ports:
    """The connections of a kind of node.

    ``takes``: the arguments of the core's step after the tick, as (topic, field); ``gives``: the
    topics that its ``out`` fills one after the other. ``optional``: inputs that may be absent
    from a node set, zero then. Empty ``takes``: all fields of all inputs in the node set's order.
    """

    takes: tuple[tuple[str, str], ...] = ()
    gives: tuple[str, ...] = ()
    optional: frozenset[str] = frozenset()


def picker(spec: NodeSpec, ports: Ports) -> Callable[[list[float]], Any]:
    """Return the function from the values of all inputs to the arguments of the core's step.

    Raises ``GraphError`` when the node set does not connect what the core takes.
    """
    if not ports.takes:
        return list
    columns = [(name, part) for name in spec.inputs for part in wire(name).fields]
    needed = {name for name, _ in ports.takes}
    for name in needed - set(spec.inputs) - ports.optional:
        raise GraphError(f"node '{spec.name}' needs {name} as an input")
    for name in set(spec.inputs) - needed:
        raise GraphError(f"node '{spec.name}' has no use for the input {name}")
    absent = len(columns)
    index = [columns.index(pair) if pair in columns else absent for pair in ports.takes]
    pick = itemgetter(*index) if len(index) > 1 else lambda values: (values[index[0]],)
    if absent not in index:
        return pick
    return lambda values: pick([*values, 0.0])


def parts(spec: NodeSpec, ports: Ports) -> list[tuple[str, int, int]]:
    """Return which numbers of a core's ``out`` go to which topic: (topic, start, stop).

    In the order in which the node set publishes; topics that a node fills by itself are left out.
    """
    gives: Sequence[str] = ports.gives or [n for n in spec.outputs if topic(n).lockstep]
    place, start = {}, 0
    for name in gives:
        stop = start + len(wire(name).fields)
        place[name] = (start, stop)
        start = stop
    return [(name, *place[name]) for name in spec.outputs if name in place]


def section(values: Mapping[str, Any], prefix: str) -> dict[str, Any]:
    """Return the entries of ``values`` under ``prefix`` without it: "load.kind" gives "kind"."""
    start = prefix + "."
    return {name[len(start) :]: v for name, v in values.items() if name.startswith(start)}
