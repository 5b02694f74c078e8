"""Whole numbers without sign in a frame, quicker than cantools, which serves all kinds."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from typing import NamedTuple

from cantools.database.can import Message, Signal

BITS = 8


class _Place(NamedTuple):
    is_little: bool
    name: str
    shift: int
    mask: int


class WholeNumbers:
    """Some of a message's signals, all whole and without sign; ``length``: bytes of its frames."""

    def __init__(self, message: Message, names: Iterable[str], length: int) -> None:
        self.length = length
        places = [_place(message.get_signal_by_name(name), length) for name in names]
        self.little = [place[1:] for place in places if place.is_little]
        self.big = [place[1:] for place in places if not place.is_little]

    def encode(self, numbers: Mapping[str, int]) -> bytes:
        """Return the data of a frame; bits of no signal are 0."""
        whole = 0
        for name, shift, mask in self.big:
            whole |= (numbers[name] & mask) << shift
        if whole:
            whole = int.from_bytes(whole.to_bytes(self.length, "big"), "little")
        for name, shift, mask in self.little:
            whole |= (numbers[name] & mask) << shift
        return whole.to_bytes(self.length, "little")

    def decode(self, data: bytes) -> dict[str, int]:
        """Return the numbers in a frame of ``length`` bytes."""
        whole = int.from_bytes(data, "little")
        found = {name: whole >> shift & mask for name, shift, mask in self.little}
        if self.big:
            whole = int.from_bytes(data, "big")
            found |= {name: whole >> shift & mask for name, shift, mask in self.big}
        return found


def _place(signal: Signal, length: int) -> _Place:
    mask = (1 << signal.length) - 1
    if signal.byte_order == "little_endian":
        return _Place(True, signal.name, signal.start, mask)
    # A DBC file counts the bits of a byte from its lowest, and names this signal's highest one.
    from_left = signal.start // BITS * BITS + BITS - 1 - signal.start % BITS
    return _Place(False, signal.name, BITS * length - from_left - signal.length, mask)
