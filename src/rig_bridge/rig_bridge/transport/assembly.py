"""CAN frames with the same counter become one packet."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from cantools.database.can import Message

from rig_bridge.transport.packets import PacketError

Parts = dict[int, dict[str, int]]


class Assembly:
    """Collects the frames of each packet; incomplete ones older than a complete one are dropped."""

    def __init__(self, messages: Mapping[int, Message], counter_bits: int) -> None:
        self.messages = messages
        self.modulus = 1 << counter_bits
        self.partial: dict[int, Parts] = {}

    def take(self, number: int, data: bytes) -> Parts | None:
        """Take a CAN frame (others than this direction's are passed over); return whole packets.

        Raises PacketError for a frame that is too short.
        """
        message = self.messages.get(number)
        if message is None:
            return None
        if len(data) < message.length:
            raise PacketError(
                f"CAN frame {message.name} of {len(data)} bytes, not {message.length}"
            )
        signals: Any = message.decode(data, decode_choices=False, scaling=False)
        counter = int(signals["Counter"])
        parts = self.partial.setdefault(counter, {})
        parts[number] = {name: int(value) for name, value in signals.items()}
        if len(parts) < len(self.messages):
            return None
        half = self.modulus // 2
        kept = {c: p for c, p in self.partial.items() if 0 < (c - counter) % self.modulus < half}
        self.partial = kept
        return parts


class Unwrapped:
    """A counter of ``bits`` bits that wraps round, as a number that does not."""

    def __init__(self, bits: int) -> None:
        self.modulus = 1 << bits
        self.value: int | None = None

    def follow(self, wrapped: int) -> int:
        """Return the number nearest to the last one that has ``wrapped`` as its low bits."""
        if self.value is None:
            self.value = wrapped
        step = (wrapped - self.value) % self.modulus
        self.value += step if step < self.modulus // 2 else step - self.modulus
        return self.value
