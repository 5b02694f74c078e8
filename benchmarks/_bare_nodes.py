"""Nodes that compute nothing, to measure what the messages cost by themselves."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any

import numpy as np

from steering_lockstep.clock_node import ClockNode
from steering_lockstep.graph import NodeSpec
from steering_lockstep.node import LockstepNode
from steering_lockstep.topics import topic, wire


class Nothing:
    """A core whose output never changes."""

    def __init__(self, size: int) -> None:
        self.out = np.zeros(size)

    def step(self, tick: int, *values: float) -> np.ndarray:
        """Return the output as it is."""
        return self.out


class BareNode(LockstepNode):
    """Publishes on each tick what has to be published on it."""

    def publish(self, tick: int, out: Any) -> None:
        """Publish zeros."""
        for name, emit in self.emit.items():
            if tick % topic(name).every == 0:
                emit(tick, (0.0,) * len(wire(name).fields))


def _builder(spec: NodeSpec) -> Callable[[Mapping[str, Any]], Nothing]:
    return lambda values: Nothing(sum(len(wire(name).fields) for name in spec.outputs))


def clock(context: Any, spec: NodeSpec, run: Any, parameters: Any) -> ClockNode:
    """Return the clock."""
    return ClockNode(context, spec, run, parameters, _builder(spec))


def node(context: Any, spec: NodeSpec, run: Any, parameters: Any) -> BareNode:
    """Return any other node."""
    return BareNode(context, spec, run, parameters, _builder(spec))
