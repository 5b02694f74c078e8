"""Collects the inputs of one node, tick by tick. Pure; every message of a run passes here."""

from __future__ import annotations

import struct
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from math import isfinite

from steering_lockstep.errors import LockstepError
from steering_lockstep.wire import Wire

REST = -1


@dataclass(frozen=True)
class Input:
    """One input: the source's message of tick k - ``delay``, or what it last published by then.

    ``every``: ticks between the source's messages; ``rest``: values before its first message.
    ``finite``: whether a number that is none is an error.
    """

    topic: str
    wire: Wire
    delay: int = 0
    every: int = 1
    rest: tuple[float, ...] = ()
    finite: bool = True

    def needed(self, tick: int) -> int:
        """Return the tick of the message that belongs to ``tick``, or ``REST``."""
        seen = tick - self.delay
        return seen // self.every * self.every if seen >= 0 else REST


class Barrier:
    """The inputs of node ``node`` at its present ``tick`` (0, period, 2 period, ...).

    ``missing`` counts the inputs that are not there yet; at 0 ``values()`` may be taken, then
    ``advance()`` goes on to the next tick. Messages of later ticks are kept until their turn.
    """

    def __init__(self, node: str, inputs: Sequence[Input], period: int = 1) -> None:
        self.node = node
        self.inputs = tuple(inputs)
        self.period = period
        self.tick = 0
        self.received = [0] * len(self.inputs)
        self._rest = [i.rest or (0.0,) * len(i.wire.fields) for i in self.inputs]
        self._held: list[Sequence[float]] = list(self._rest)
        self._need = [i.needed(0) for i in self.inputs]
        self._early: list[dict[int, Sequence[float]]] = [{} for _ in self.inputs]
        self.missing = sum(need != REST for need in self._need)
        self._simple = all(i.delay == 0 and i.every == 1 for i in self.inputs) and period == 1

    def receiver(self, index: int, complete: Callable[[], None]) -> Callable[[bytes], None]:
        """Return the function that takes the bytes of input ``index``.

        It calls ``complete`` when nothing is missing any more, and raises ``LockstepError`` for a
        message of a wrong size, out of turn, or with a number that is not finite.
        """
        unpack, every = self.inputs[index].wire.unpack, self.inputs[index].every
        any_number = not self.inputs[index].finite
        need, held, early, received = self._need, self._held, self._early[index], self.received

        def receive(data: bytes) -> None:
            try:
                tick, *values = unpack(data)
            except struct.error:
                raise self._wrong_size(index, data) from None
            if tick != received[index] * every:
                raise self._out_of_turn(index, tick)
            if not (isfinite(sum(values)) or any_number):
                raise not_finite(self.node, self.inputs[index], tick, values)
            received[index] += 1
            if tick == need[index]:
                held[index] = values
                self.missing -= 1
                if not self.missing:
                    complete()
            elif tick > need[index]:
                early[tick] = values

        return receive

    def values(self) -> list[float]:
        """Return the values of all inputs one after the other; only when nothing is missing."""
        flat: list[float] = []
        for values in self._held:
            flat += values
        return flat

    def advance(self) -> bool:
        """Go on to the node's next tick; return whether its inputs are there already."""
        self.tick = tick = self.tick + self.period
        if self._simple and not any(self._early):
            self._need[:] = [tick] * len(self._need)
            self.missing = len(self._need)
            return not self.missing
        self.missing = 0
        for index, entry in enumerate(self.inputs):
            self._look_for(index, entry.needed(tick))
        return not self.missing

    def lacking(self) -> tuple[str, ...]:
        """Return the topics that are missing for the present tick."""
        return tuple(
            entry.topic
            for index, entry in enumerate(self.inputs)
            if self._need[index] >= self.received[index] * entry.every
        )

    def _look_for(self, index: int, need: int) -> None:
        if need == self._need[index] and need < self.received[index] * self.inputs[index].every:
            return
        self._need[index] = need
        early = self._early[index]
        if need in early:
            self._held[index] = early.pop(need)
            for tick in [t for t in early if t < need]:
                del early[tick]
        elif need != REST:
            self.missing += 1

    def _wrong_size(self, index: int, data: bytes) -> LockstepError:
        entry = self.inputs[index]
        text = f"message of {len(data)} bytes, expected {entry.wire.size} ({entry.wire.type_name})"
        return LockstepError("size", self.node, entry.topic, self.tick, text)

    def _out_of_turn(self, index: int, tick: int) -> LockstepError:
        entry = self.inputs[index]
        expected = self.received[index] * entry.every
        what = "came again or late" if tick < expected else "came too early: messages were lost"
        text = f"message of tick {tick} {what}; expected tick {expected}"
        return LockstepError("order", self.node, entry.topic, tick, text)


def not_finite(node: str, entry: Input, tick: int, values: Sequence[float]) -> LockstepError:
    """Return the error for a message with a NaN or an infinity, naming its first such field."""
    bad = [n for n, v in zip(entry.wire.fields, values, strict=True) if not isfinite(v)]
    text = f"field {bad[0]} is not finite" if bad else "the fields' sum is not finite"
    return LockstepError("not_finite", node, entry.topic, tick, text)
