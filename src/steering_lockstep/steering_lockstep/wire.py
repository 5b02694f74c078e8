"""Byte layout (little-endian CDR) of a message of fixed size, computed from its definition.

With constant strings (frame_id) every field of a message sits at a fixed place. Packing is then
one ``struct`` call, and an array of messages is a structured numpy array: the same bytes that the
middleware's own serialiser makes, without a message object.
"""

from __future__ import annotations

import struct
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from steering_lockstep.msg_text import Leaf, leaves

ENCAPSULATION = b"\x00\x01\x00\x00"
TICKS_PER_SECOND = 1000
NANOSECONDS_PER_TICK = 1_000_000
_STAMPS = ("header.stamp.", "clock.")

Pack = Callable[[int, Sequence[float]], bytes]
Unpack = Callable[[bytes], tuple[Any, ...]]


@dataclass(frozen=True)
class Slot:
    """One field at its place: ``offset`` from the first byte of the message, encapsulation in."""

    path: str
    code: str
    offset: int
    size: int
    constant: bytes | None = None

    @property
    def is_whole(self) -> bool:
        """Return whether the field holds a whole number."""
        return self.code in "bBhHiIqQ"


class Wire:
    """Layout of one message type with its strings fixed.

    ``fields``: paths of the numbers that ``pack`` takes and ``unpack`` gives, in wire order, an
    array being one path a number ("pose.covariance[0]"); the stamp and ``tick`` are not among
    them. ``size`` in bytes; ``dtype``: numpy layout of the whole message, its fields named
    "tick" (where there is one), "sec", "nanosec" and ``fields``.
    """

    def __init__(self, type_name: str, strings: Mapping[str, str] | None = None) -> None:
        self.type_name = type_name
        self.slots = _place(leaves(type_name), strings or {})
        self.size = self.slots[-1].offset + self.slots[-1].size
        numbers = [s for s in self.slots if s.constant is None]
        self.has_tick = any(s.path == "tick" for s in numbers)
        self.fields = tuple(s.path for s in numbers if not _is_time(s.path))
        self.dtype = _dtype(numbers, self.size)
        self.template = bytes(self._blank())
        whole = {i for i, s in enumerate(s for s in numbers if not _is_time(s.path)) if s.is_whole}
        self.pack: Pack = _rounding(_packer(self.slots, self.has_tick), whole)
        self.unpack: Unpack = _unpacker(self.slots, self.size, self.has_tick)

    def array(self, count: int) -> np.ndarray:
        """Return ``count`` messages as a structured array with all constants in place."""
        return np.frombuffer(bytearray(self.template * count), dtype=self.dtype)

    def view(self, data: bytes) -> np.ndarray:
        """View bytes of messages one after the other as a structured array (read only)."""
        return np.frombuffer(data, dtype=self.dtype)

    def from_columns(self, ticks: np.ndarray, columns: np.ndarray) -> np.ndarray:
        """Return messages of ``ticks`` (n,) with values ``columns`` (n, len(fields))."""
        messages = self.array(len(ticks))
        messages["sec"] = ticks // TICKS_PER_SECOND
        messages["nanosec"] = ticks % TICKS_PER_SECOND * NANOSECONDS_PER_TICK
        if self.has_tick:
            messages["tick"] = ticks
        for index, name in enumerate(self.fields):
            messages[name] = columns[:, index]
        return messages

    def _blank(self) -> bytearray:
        blank = bytearray(self.size)
        blank[: len(ENCAPSULATION)] = ENCAPSULATION
        for slot in self.slots:
            if slot.constant is not None:
                blank[slot.offset : slot.offset + slot.size] = slot.constant
        return blank


def _place(fields: Any, strings: Mapping[str, str]) -> tuple[Slot, ...]:
    """Lay the fields out: CDR aligns each number to its size, counted after the encapsulation."""
    slots: list[Slot] = []
    offset = len(ENCAPSULATION)
    for leaf in fields:
        if leaf.code == "s":
            text = strings.get(leaf.path, "").encode() + b"\0"
            constant = struct.pack("<I", len(text)) + text
            offset = _aligned(offset, 4)
            slots.append(Slot(leaf.path, "s", offset, len(constant), constant))
            offset += len(constant)
            continue
        size = struct.calcsize("<" + leaf.code)
        offset = _aligned(offset, size)
        for path in _paths(leaf):
            slots.append(Slot(path, leaf.code, offset, size))
            offset += size
    return tuple(slots)


def _paths(leaf: Leaf) -> list[str]:
    return [leaf.path] if leaf.count == 1 else [f"{leaf.path}[{i}]" for i in range(leaf.count)]


def _aligned(offset: int, size: int) -> int:
    start = len(ENCAPSULATION)
    return start + -(-(offset - start) // size) * size


def _is_time(path: str) -> bool:
    return path == "tick" or path.startswith(_STAMPS)


def _dtype(numbers: Sequence[Slot], size: int) -> np.dtype:
    names = [s.path.rsplit(".", 1)[-1] if s.path.startswith(_STAMPS) else s.path for s in numbers]
    return np.dtype(
        {
            "names": names,
            "formats": ["<" + np.dtype(s.code).str[1:] for s in numbers],
            "offsets": [s.offset for s in numbers],
            "itemsize": size,
        }
    )


def _packer(slots: Sequence[Slot], has_tick: bool) -> Pack:
    """Build ``pack(tick, values)``. The bytes up to the stamp and each string are arguments."""
    layout, constants = _format(slots)
    before = tuple(constants)
    make = struct.Struct(layout).pack
    if len(before) == 2 and has_tick:
        head, frame = before
        return lambda tick, values: make(
            head,
            tick // TICKS_PER_SECOND,
            tick % TICKS_PER_SECOND * NANOSECONDS_PER_TICK,
            frame,
            tick,
            *values,
        )
    order = _argument_order(slots, has_tick)

    def pack(tick: int, values: Sequence[float]) -> bytes:
        time = (tick // TICKS_PER_SECOND, tick % TICKS_PER_SECOND * NANOSECONDS_PER_TICK)
        return make(before[0], *order((*before[1:], *time, *((tick,) if has_tick else ())), values))

    return pack


def _rounding(pack: Pack, whole: set[int]) -> Pack:
    """Return ``pack`` for values whose ``whole`` ones are floats that stand for whole numbers."""
    if not whole:
        return pack

    def packed(tick: int, values: Sequence[float]) -> bytes:
        return pack(tick, [int(v) if i in whole else v for i, v in enumerate(values)])

    return packed


def _format(slots: Sequence[Slot]) -> tuple[str, list[bytes]]:
    """Return the ``struct`` format of the whole message and its constant pieces."""
    layout, at = f"<{len(ENCAPSULATION)}s", len(ENCAPSULATION)
    constants = [ENCAPSULATION]
    for slot in slots:
        layout += f"{slot.offset - at}x"
        if slot.constant is None:
            layout += slot.code
        else:
            layout += f"{slot.size}s"
            constants.append(slot.constant)
        at = slot.offset + slot.size
    return layout, constants


def _argument_order(slots: Sequence[Slot], has_tick: bool) -> Callable[..., tuple[Any, ...]]:
    """Return a function that sorts (strings, sec, nanosec, tick) and values into wire order."""
    strings = [s.path for s in slots if s.constant is not None]
    stamp = [s.path for s in slots if s.path.startswith(_STAMPS)]
    known = strings + stamp + (["tick"] if has_tick else [])
    rest = [s.path for s in slots if s.constant is None and not _is_time(s.path)]
    index = [
        known.index(s.path) if s.path in known else len(known) + rest.index(s.path) for s in slots
    ]

    def order(fixed: tuple[Any, ...], values: Sequence[float]) -> tuple[Any, ...]:
        every = (*fixed, *values)
        return tuple([every[i] for i in index])

    return order


def _unpacker(slots: Sequence[Slot], size: int, has_tick: bool) -> Unpack:
    """Build ``unpack(data) -> (tick, *values)``; raises ``struct.error`` on a wrong size."""
    layout, at = "<", 0
    for slot in slots:
        if slot.constant is not None or (has_tick and slot.path.startswith(_STAMPS)):
            continue
        layout += f"{slot.offset - at}x{slot.code}"
        at = slot.offset + slot.size
    take = struct.Struct(layout + f"{size - at}x").unpack
    if has_tick and slots_lead_with_tick(slots):
        return take

    def unpack(data: bytes) -> tuple[Any, ...]:
        sec, nanosec, *values = take(data)
        return (sec * TICKS_PER_SECOND + nanosec // NANOSECONDS_PER_TICK, *values)

    return unpack


def slots_lead_with_tick(slots: Sequence[Slot]) -> bool:
    """Return whether ``tick`` is the first number after the header, as in all our messages."""
    numbers = [s.path for s in slots if s.constant is None and not s.path.startswith(_STAMPS)]
    return bool(numbers) and numbers[0] == "tick"
