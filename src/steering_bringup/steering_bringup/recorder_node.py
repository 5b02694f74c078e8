"""The recorder as a node: every published byte into a bag, as a member of the barrier.

It may lag behind the clock by the ticks of its credit; then the clock waits, so nothing is lost.
Parameters: ``path`` of the bag, ``metadata`` (JSON: what is needed to repeat the run),
``overwrite``, ``compress``.
"""

from __future__ import annotations

import json
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any

import numpy as np
from rclpy.context import Context

from steering_bringup.bags import BagError, BagWriter
from steering_lockstep.errors import LockstepError
from steering_lockstep.graph import NodeSpec
from steering_lockstep.node import LockstepNode
from steering_lockstep.settings import CREDIT_EVERY, RunSettings
from steering_lockstep.topics import CREDIT, topic, wire
from steering_lockstep.wire import NANOSECONDS_PER_TICK

COLLECT_EVERY = 0.004
"""s; the recorder is not in the loop's way, and being woken for each message costs more than it."""


class RecorderNode(LockstepNode):
    """Keeps the bytes of each topic, and writes them in blocks of whole ticks."""

    def __init__(
        self,
        context: Context,
        spec: NodeSpec,
        run: RunSettings,
        parameters: Mapping[str, Any] | None,
    ) -> None:
        self.kept: dict[str, list[bytes]] = {name: [] for name in spec.inputs}
        self.written = dict.fromkeys(spec.inputs, 0)
        self.lost = dict.fromkeys(spec.inputs, 0)
        self.done = 0
        self.failed = False
        super().__init__(context, spec, run, parameters)
        self.wake_for(())
        self.create_timer(COLLECT_EVERY, self.collect)
        self._every = {name: run.every(name) for name in spec.inputs}
        values = self.values()
        types = {name: topic(name).type_name.replace("/", "/msg/") for name in spec.inputs}
        self.writer = BagWriter(
            Path(values["path"]),
            types,
            json.loads(values.get("metadata", "{}")),
            overwrite=bool(values.get("overwrite", False)),
            compress=bool(values.get("compress", False)),
        )

    def receiver(self, index: int) -> Callable[[bytes], None]:
        """Return the function that keeps the bytes of input ``index``."""
        return self.kept[list(self.spec.inputs)[index]].append

    def collect(self) -> None:
        """Take every message that has come in, then write the whole ticks."""
        try:
            self.take_all()
            self.drain()
        except LockstepError as error:
            self.failed = True
            self.on_error(error)

    def take_all(self) -> None:
        """Take every message that has come in."""
        for name, entry in self.raw.items():
            take, kind, keep = entry.handle.take_message, entry.msg_type, self.kept[name].append
            while (taken := take(kind, True)) is not None:
                keep(taken[0])

    def lacking(self) -> tuple[str, ...]:
        """Return the topics whose next message is not there."""
        return tuple(name for name, kept in self.kept.items() if not kept and not self._all(name))

    def drain(self) -> None:
        """Write all whole ticks that are there, and give the clock credit for them."""
        ends = [self._known_until(name) for name in self.kept]
        end = min(ends, default=self.done)
        if end < self.run.ticks:
            end -= end % CREDIT_EVERY
        if end <= self.done or self.finished:
            return
        for every in sorted(set(self._every.values())):
            self._write_block([n for n, e in self._every.items() if e == every], every, end)
        self.done = self.barrier.tick = end
        self.emit[CREDIT](end - 1, ())
        if end >= self.run.ticks:
            self._finish()

    def close(self) -> None:
        """Write what has come in and is not written yet, and close the bag.

        After a failure nothing is added: the bag ends before the gap, not behind it.
        """
        if self.done < self.run.ticks:
            self.writer.broken_off(self.done, self.run.ticks)
        try:
            if self.failed:
                return
            self.take_all()
            for name, kept in self.kept.items():
                for data in kept:
                    stamp = wire(name).unpack(data)[0] * NANOSECONDS_PER_TICK
                    self.writer.write(name, stamp, data)
        finally:
            self.writer.close()

    def result(self) -> dict[str, Any]:
        """Return counts and the bag's path."""
        return {
            **super().result(),
            "lost": self.lost,
            "written": self.written,
            "bag": str(self.writer.path),
        }

    def _all(self, name: str) -> bool:
        return self.written[name] >= self.run.messages(name)

    def _known_until(self, name: str) -> int:
        """Return the tick up to which all messages of a topic are there."""
        count = self.written[name] + len(self.kept[name])
        return min(count * self._every[name], self.run.ticks)

    def _write_block(self, names: list[str], every: int, end: int) -> None:
        """Write the messages of the ticks before ``end`` of topics with the same period."""
        first = -(-self.done // every) * every
        ticks = np.arange(first, end, every)
        if not len(ticks):
            return
        payloads = {name: self._cut(name, ticks) for name in names}
        try:
            self.writer.write_block(ticks * NANOSECONDS_PER_TICK, payloads)
        except BagError as error:
            raise LockstepError("record", self.spec.name, None, self.done, str(error)) from error
        for name in names:
            self.written[name] += len(ticks)

    def _cut(self, name: str, ticks: np.ndarray) -> np.ndarray:
        """Take the bytes of ``ticks`` out of what is kept, shape (n, size); check the ticks."""
        kept, layout = self.kept[name], wire(name)
        data = b"".join(kept[: len(ticks)])
        if len(data) != len(ticks) * layout.size:
            text = f"a message has not the {layout.size} bytes of {layout.type_name}"
            raise LockstepError("size", self.spec.name, name, int(ticks[0]), text)
        messages = layout.view(data)
        seconds, rest = messages["sec"].astype(np.int64), messages["nanosec"]
        gaps = seconds * 1000 + rest // NANOSECONDS_PER_TICK - ticks
        if gaps.any():
            self.lost[name] += int(gaps.max()) // self._every[name]
            first = int(ticks[np.argmax(gaps != 0)])
            raise LockstepError("order", self.spec.name, name, first, "messages were lost")
        del kept[: len(ticks)]
        return np.frombuffer(data, np.uint8).reshape(len(ticks), layout.size)


def make(
    context: Context, spec: NodeSpec, run: RunSettings, parameters: Mapping[str, Any] | None
) -> RecorderNode:
    """Return the recorder's node for a run."""
    return RecorderNode(context, spec, run, parameters)
