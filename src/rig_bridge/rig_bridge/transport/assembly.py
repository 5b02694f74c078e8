"""CAN frames with the same counter become one packet."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from typing import Any, NamedTuple

from rig_bridge.transport.can_layout import Key, Slot
from rig_bridge.transport.packets import OwnFrameError, PacketError


class Part(NamedTuple):
    """A frame of a packet: its signals and its data as they came."""

    signals: Mapping[str, Any]
    data: bytes


Parts = dict[Key, Part]


class Assembly:
    """Collects the frames of each packet; incomplete ones older than a complete one are dropped.

    slots: the messages of a packet. own: those that one end only sends, which are not taken here.
    quick: how to read those frames that are not left to cantools.
    """

    def __init__(
        self,
        slots: Mapping[Key, Slot],
        own: Mapping[Key, Slot],
        counter_bits: int,
        quick: Mapping[Key, Callable[[bytes], Mapping[str, int]]] | None = None,
    ) -> None:
        self.slots = slots
        self.quick = quick or {}
        self.own = own
        self.alike = {key[:2]: slot for key, slot in slots.items()}
        self.modulus = 1 << counter_bits
        self.partial: dict[int, Parts] = {}
        self.heard: set[Key] = set()

    def take(self, key: Key, data: bytes, fd: bool) -> Parts | None:
        """Take a CAN frame (others' are passed over); return a packet once it is whole.

        Raises PacketError for a frame that only looks like one of this direction.
        """
        slot = self.slots.get(key)
        if slot is None:
            self._check_foreign(key)
            return None
        if len(data) != slot.length or fd is not slot.fd:
            raise PacketError(_unlike(slot, len(data), fd))
        signals = self._read(key, slot, data)
        counter = signals["Counter"]
        parts = self.partial.setdefault(counter, {})
        parts[key] = Part(signals, data)
        self.heard.add(key)
        if len(parts) < len(self.slots):
            return None
        self.heard.clear()
        half = self.modulus // 2
        kept = {c: p for c, p in self.partial.items() if 0 < (c - counter) % self.modulus < half}
        self.partial = kept
        return parts

    def _read(self, key: Key, slot: Slot, data: bytes) -> Mapping[str, Any]:
        quick = self.quick.get(key)
        if quick is not None:
            return quick(data)
        signals: Any = slot.message.decode(data, decode_choices=False, scaling=False)
        return signals

    def unheard(self) -> list[Slot]:
        """Return the messages that have not come since the last whole packet."""
        return [slot for key, slot in self.slots.items() if key not in self.heard]

    def _check_foreign(self, key: Key) -> None:
        if key in self.own:
            raise OwnFrameError(f"somebody else sends {self.own[key].message.name}")
        alike = self.alike.get(key[:2])
        if alike is not None:
            bits = 29 if key[2] else 11
            text = f"identifier 0x{key[1]:X} of {bits} bits"
            raise PacketError(f"{text} is not {alike.message.name}, which has {alike.bits}")


def describe(slots: Iterable[Slot]) -> str:
    """Return the names of messages, bus by bus."""
    buses: dict[str, list[str]] = {}
    for slot in slots:
        buses.setdefault(slot.bus_name, []).append(slot.message.name)
    return "; ".join(f"{', '.join(names)} on {bus}" for bus, names in buses.items())


def _unlike(slot: Slot, length: int, fd: bool) -> str:
    kinds = {True: "CAN FD", False: "classic CAN"}
    if fd is not slot.fd:
        return f"{slot.message.name} came as a frame of {kinds[fd]}, not of {kinds[slot.fd]}"
    return f"CAN frame {slot.message.name} of {length} bytes, not {slot.length}"


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
