"""Nodes of one process hand messages over by a call; what others read can wait. Pure.

As the intra-process communication of rclcpp does, which rclpy lacks: the same bytes, in the same
order on each topic.
"""

from __future__ import annotations

from collections import deque
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from typing import Protocol

from steering_lockstep.graph import NodeSpec
from steering_lockstep.settings import RunSettings

Take = Callable[[bytes], None]


class Outbox:
    """Publishes at once, or, while it is ``held``, when that is over."""

    def __init__(self) -> None:
        self._held = False
        self._waiting: deque[tuple[Take, bytes]] = deque()

    @contextmanager
    def held(self) -> Iterator[None]:
        """Keep what is sent until the end of the context: something else comes first."""
        self._held = True
        try:
            yield
        finally:
            self._held = False
            while self._waiting:
                publish, data = self._waiting.popleft()
                publish(data)

    def send(self, publish: Take, data: bytes) -> None:
        """Call ``publish`` with ``data``, now or later."""
        if self._held:
            self._waiting.append((publish, data))
        else:
            publish(data)


class Neighbour(Protocol):
    """A node as those beside it see it.

    ``takers``: for each input what takes a message's bytes; ``outlets``: for each output where they
    go, at first to the topic alone.
    """

    spec: NodeSpec
    outbox: Outbox
    outlets: dict[str, Take]

    @property
    def takers(self) -> Mapping[str, Take]: ...  # noqa: D102


def introduce(nodes: Sequence[Neighbour], run: RunSettings) -> None:
    """Let the nodes of a process hand their messages over to each other, as ``run`` says.

    A topic that a node elsewhere waits for is published at once, any other through one outbox.
    """
    outbox = Outbox()
    by_name = {node.spec.name: node for node in nodes}
    for node in nodes:
        node.outbox = outbox
        for name, publish in node.outlets.items():
            takers = [by_name[reader.name].takers[name] for reader in run.handed(name)]
            node.outlets[name] = _outlet(publish, takers, None if run.awaited(name) else outbox)


def _outlet(publish: Take, takers: Sequence[Take], outbox: Outbox | None) -> Take:
    def give(data: bytes) -> None:
        if outbox is None:
            publish(data)
        else:
            outbox.send(publish, data)
        for take in takers:
            take(data)

    return give
