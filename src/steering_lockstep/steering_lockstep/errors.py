"""What can go wrong at a node, each with the node, topic and tick that it happened at."""

from __future__ import annotations


class LockstepError(RuntimeError):
    """A broken contract. ``kind`` as in ``RunError``; the text names node, topic and tick."""

    def __init__(self, kind: str, node: str, topic: str | None, tick: int | None, text: str):
        where = f"node '{node}'"
        if topic is not None:
            where += f", topic {topic}"
        if tick is not None:
            where += f", tick {tick}"
        super().__init__(f"{where}: {text}")
        self.kind = kind
        self.node = node
        self.topic = topic
        self.tick = tick
