"""What every node of a run must know: the graph, its length, rest values, pacing. Pure."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field

from steering_lockstep.barrier import Input
from steering_lockstep.graph import Graph, NodeSpec
from steering_lockstep.names import NAMES, Names
from steering_lockstep.topics import CREDIT, topic, wire

CREDIT_TICKS = 1000
CREDIT_EVERY = 100


@dataclass(frozen=True)
class RunSettings:
    """``ticks``: 0 to ticks - 1; ``rest``: values before a delayed input's first message.

    ``urgent``: wall time counts, because hardware is the clock. ``together``: the nodes of this
    process, where they hand messages over to each other by a call. ``names``: how others see its
    topics; ``wait_for``: topics with a listener outside the graph, which is waited for.
    """

    graph: Graph
    ticks: int
    rest: Mapping[str, Sequence[float]] = field(default_factory=dict)
    real_time: bool = False
    urgent: bool = False
    together: frozenset[str] = frozenset()
    names: Names = NAMES
    wait_for: frozenset[str] = frozenset()

    def every(self, name: str) -> int:
        """Return the ticks between two messages on topic ``name``."""
        return self.graph.node(self.graph.publisher[name]).period * topic(name).every

    def messages(self, name: str) -> int:
        """Return how many messages topic ``name`` carries in the whole run."""
        return -(-self.ticks // self.every(name))

    def inputs(self, spec: NodeSpec) -> list[Input]:
        """Return the inputs of a node for its barrier."""
        return [
            Input(
                name,
                wire(name),
                delay,
                self.every(name),
                tuple(float(v) for v in self.rest.get(name, ())),
                topic(name).finite,
            )
            for name, delay in spec.inputs.items()
        ]

    def handed(self, name: str) -> tuple[NodeSpec, ...]:
        """Return who gets topic ``name`` by a call; a recorder takes what is published."""
        if self.graph.publisher[name] not in self.together:
            return ()
        readers = (n for n in self.graph.readers(name) if n.name in self.together)
        return tuple(n for n in readers if CREDIT not in n.outputs)

    def awaited(self, name: str) -> bool:
        """Return whether a node in another process waits for topic ``name``."""
        handed = self.handed(name)
        elsewhere = [node for node in self.graph.readers(name) if node not in handed]
        return any(CREDIT not in node.outputs for node in elsewhere)

    def readers(self, name: str) -> int:
        """Return how many subscriptions of the graph topic ``name`` has."""
        return len(self.graph.readers(name)) - len(self.handed(name)) + (name == CREDIT)

    def awaited_readers(self, name: str) -> int:
        """Return how many subscriptions there must be before tick 0, a listener's among them."""
        return self.readers(name) + (name in self.wait_for)
