"""Inputs of a clock that waits for nobody: the newest message is used until a newer comes. Pure."""

from __future__ import annotations

import struct
from collections.abc import Callable, Sequence

from steering_lockstep.barrier import REST, Barrier, Input


class Held(Barrier):
    """As a barrier, but ``values()`` and ``advance()`` may be called while inputs are missing.

    A late message replaces an older one when it comes. A number that is none is passed on: whoever
    uses it decides. ``used``: tick of the message that each input stands at, or ``REST``.
    """

    def __init__(self, node: str, inputs: Sequence[Input], period: int = 1) -> None:
        super().__init__(node, inputs, period)
        self.used = [REST] * len(self.inputs)

    def receiver(self, index: int, complete: Callable[[], None]) -> Callable[[bytes], None]:
        """Return the function that takes the bytes of input ``index``; see ``Barrier``."""
        unpack, every = self.inputs[index].wire.unpack, self.inputs[index].every

        def receive(data: bytes) -> None:
            try:
                tick, *values = unpack(data)
            except struct.error:
                raise self._wrong_size(index, data) from None
            if tick != self.received[index] * every:
                raise self._out_of_turn(index, tick)
            self.received[index] += 1
            if tick > self._need[index]:
                self._early[index][tick] = values
                return
            self._held[index], self.used[index] = values, tick
            if tick == self._need[index]:
                self.missing -= 1
                if not self.missing:
                    complete()

        return receive

    def advance(self) -> bool:
        """Go on to the next tick, whatever is missing; return whether its inputs are there."""
        self.tick += self.period
        self.missing = 0
        for index, entry in enumerate(self.inputs):
            need = self._need[index] = entry.needed(self.tick)
            early = self._early[index]
            for tick in [tick for tick in early if tick <= need]:
                self._held[index], self.used[index] = early.pop(tick), tick
            self.missing += self.used[index] < need
        return not self.missing

    def age(self) -> int:
        """Return by how many ticks the oldest value is older than it should be."""
        return max((self._age(index) for index in range(len(self.inputs))), default=0)

    def oldest(self) -> str | None:
        """Return the topic that is furthest behind; None if none is."""
        ages = {self._age(index): entry.topic for index, entry in enumerate(self.inputs)}
        age = max(ages, default=0)
        return ages[age] if age else None

    def _age(self, index: int) -> int:
        return self._need[index] - self.used[index]
