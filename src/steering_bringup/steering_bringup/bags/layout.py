"""Where each number sits in a CDR payload, as a numpy dtype over whole payloads.

Strings and sequences make a type's size depend on its content. In a lock-step run that content
is constant (a frame_id, a covariance), so the first message fixes the layout and the lengths in
all others are checked against it.
"""

from __future__ import annotations

import struct
from dataclasses import dataclass
from typing import Any

import numpy as np
from rosbags.interfaces import Nodetype
from rosbags.typesys.store import Typestore

ENCAPSULATION = 4
_LITTLE_ENDIAN_CDR = 1
_NUMPY_NAMES = {"bool": "u1", "byte": "u1", "char": "u1", "octet": "u1"}


class _NotFixedError(Exception):
    """The type has a part whose place cannot be known without decoding every message."""


@dataclass(frozen=True)
class Layout:
    """Layout of one topic's payloads; `dtype.itemsize` is the payload size in bytes.

    `lengths` are (byte offset, value) of every string or sequence length in the payload.
    """

    msgtype: str
    dtype: np.dtype[Any]
    lengths: tuple[tuple[int, int], ...]

    def fits(self, payloads: np.ndarray) -> bool:
        """Whether payloads (n, size) uint8 have the same string and sequence lengths."""
        for offset, value in self.lengths:
            here = payloads[:, offset : offset + 4].copy().view("<u4")
            if not bool(np.all(here == value)):
                return False
        return payloads.shape[1] == self.dtype.itemsize

    def rows(self, payloads: np.ndarray) -> np.ndarray:
        """Payloads (n, size) uint8, contiguous, viewed as structured rows (n,)."""
        return payloads.view(self.dtype).reshape(-1)


def layout_of(msgtype: str, store: Typestore, sample: bytes) -> Layout | None:
    """Layout of `msgtype` with the string lengths of `sample`; None if it has no fixed layout."""
    if len(sample) < ENCAPSULATION or sample[1] != _LITTLE_ENDIAN_CDR:
        return None
    walk = _Walk(store, sample)
    try:
        walk.message(msgtype, "")
    except (_NotFixedError, struct.error, KeyError):
        return None
    if walk.position > len(sample):
        return None
    dtype = np.dtype(
        {
            "names": walk.names,
            "formats": walk.formats,
            "offsets": walk.offsets,
            "itemsize": len(sample),
        }
    )
    return Layout(msgtype, dtype, tuple(walk.lengths))


class _Walk:
    """One pass over a message's fields that keeps the byte position."""

    def __init__(self, store: Typestore, sample: bytes) -> None:
        self.store = store
        self.sample = sample
        self.position = ENCAPSULATION
        self.names: list[str] = []
        self.formats: list[str] = []
        self.offsets: list[int] = []
        self.lengths: list[tuple[int, int]] = []

    def message(self, msgtype: str, prefix: str) -> None:
        for name, (kind, detail) in self.store.fielddefs[msgtype][1]:
            self.field(prefix + name, kind, detail)

    def field(self, name: str, kind: Any, detail: Any) -> None:
        if kind == Nodetype.NAME:
            self.message(detail, name + ".")
        elif kind == Nodetype.BASE and detail[0] in ("string", "wstring"):
            self.text(name, detail[0])
        elif kind == Nodetype.BASE:
            self.number(name, detail[0], None)
        elif kind == Nodetype.ARRAY:
            self.array(name, detail[0], detail[1])
        else:
            self.array(name, detail[0], self.length())

    def align(self, size: int) -> None:
        # CDR aligns relative to the byte after the encapsulation header.
        self.position += -(self.position - ENCAPSULATION) % size

    def length(self) -> int:
        self.align(4)
        (value,) = struct.unpack_from("<I", self.sample, self.position)
        self.lengths.append((self.position, value))
        self.position += 4
        return int(value)

    def text(self, name: str, kind: str) -> None:
        if kind == "wstring":
            raise _NotFixedError
        size = self.length()
        self.add(name, f"S{size}", size) if size else None

    def array(self, name: str, element: Any, count: int) -> None:
        kind, detail = element
        if kind != Nodetype.BASE or detail[0] in ("string", "wstring"):
            raise _NotFixedError
        if count:
            self.number(name, detail[0], count)

    def number(self, name: str, primitive: str, count: int | None) -> None:
        single = np.dtype(_NUMPY_NAMES.get(primitive, primitive)).newbyteorder("<")
        self.align(single.itemsize)
        code = single.str if count is None else f"{count}{single.str}"
        self.add(name, code, single.itemsize * (count or 1))

    def add(self, name: str, code: str, size: int) -> None:
        self.names.append(name)
        self.formats.append(code)
        self.offsets.append(self.position)
        self.position += size
