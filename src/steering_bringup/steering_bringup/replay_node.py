"""A node in another's place: it waits for the same inputs and publishes recorded bytes.

Parameter: ``bag``, the folder of a bag that holds the node's topics at every tick of the run.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np
from rclpy.context import Context

from steering_bringup.replays import is_clock, load_replay
from steering_lockstep.clock_node import ClockNode
from steering_lockstep.graph import NodeSpec
from steering_lockstep.node import LockstepNode
from steering_lockstep.settings import RunSettings


class Recording:
    """Stands for a core: the messages of each topic, one after the other as bytes."""

    def __init__(self, messages: Mapping[str, tuple[bytes, int]]) -> None:
        self.messages = messages
        self.out = np.zeros(0)

    def step(self, tick: int, *values: float) -> np.ndarray:
        """Take the inputs of a tick and compute nothing."""
        return self.out


class Replaying:
    """Publishes the recorded bytes of a tick when the node's inputs of that tick have come."""

    core: Recording
    run: RunSettings
    forward: Callable[[str, bytes], None]

    def publish(self, tick: int, out: Sequence[float]) -> None:
        """Publish each topic whose turn it is at ``tick``."""
        for name, (data, size) in self.core.messages.items():
            index, rest = divmod(tick, self.run.every(name))
            if rest == 0:
                self.forward(name, data[index * size : (index + 1) * size])


class ReplayNode(Replaying, LockstepNode):
    """In the place of a node that answers the clock."""


class ReplayClock(Replaying, ClockNode):
    """In the place of the clock: recorded measurements, whatever the commands are."""


def recording(spec: NodeSpec, run: RunSettings) -> Callable[[Mapping[str, Any]], Recording]:
    """Return the function that reads the bag named by a node's parameters, once."""
    read: dict[str, Recording] = {}

    def build(values: Mapping[str, Any]) -> Recording:
        if "bag" not in values:
            raise ValueError("the parameter 'bag' is missing")
        name = str(values["bag"])
        if name not in read:
            payloads = load_replay(spec, run, Path(name)).payloads
            read[name] = Recording({t: (p.tobytes(), p.shape[1]) for t, p in payloads.items()})
        return read[name]

    return build


def make(
    context: Context, spec: NodeSpec, run: RunSettings, parameters: Mapping[str, Any] | None
) -> LockstepNode:
    """Return the replaying node for a run."""
    kind = ReplayClock if is_clock(spec) else ReplayNode
    return kind(context, spec, run, parameters, recording(spec, run))
