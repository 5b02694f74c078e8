"""The bytes of an MCAP file: record numbers, and numbers and texts at a place in it."""

from __future__ import annotations

import mmap
import struct
from pathlib import Path
from typing import Any

import numpy as np

MAGIC = b"\x89MCAP0\r\n"
FOOTER, SCHEMA, CHANNEL, MESSAGE, CHUNK, MESSAGE_INDEX = 0x02, 0x03, 0x04, 0x05, 0x06, 0x07
STATISTICS, DATA_END = 0x0B, 0x0F
CUT_CHUNK = -1  # not in the file format: a chunk record whose end is missing
RECORD_HEAD = 9
PAYLOAD = 31  # from a message record's start to its payload
LOG_TIME = 15

head = struct.Struct("<BQ").unpack_from
chunk_head = struct.Struct("<QQQI").unpack_from
u16 = struct.Struct("<H").unpack_from
u32 = struct.Struct("<I").unpack_from
u64 = struct.Struct("<Q").unpack_from


def text_at(data: memoryview, position: int) -> tuple[str, int]:
    """Return the text at a position, and the position after it."""
    (size,) = u32(data, position)
    end = position + 4 + size
    return data[position + 4 : end].tobytes().decode("utf-8", "replace"), end


def map_file(file: Path) -> memoryview:
    """A file's bytes without reading them into memory; they outlive its renaming. OSError."""
    with file.open("rb") as handle:
        if file.stat().st_size == 0:
            return memoryview(b"")
        return memoryview(mmap.mmap(handle.fileno(), 0, access=mmap.ACCESS_READ))


def gather(content: memoryview, offsets: np.ndarray, dtype: np.dtype[Any]) -> np.ndarray:
    """Values of `dtype` at byte `offsets` of `content`, whatever their alignment: (n,)."""
    count = len(content) - dtype.itemsize + 1
    if count <= 0 or not len(offsets):
        return np.empty(0, dtype)
    windows = np.ndarray((count,), dtype, buffer=content, strides=(1,))
    return windows[offsets]
