"""Low-level pass over an MCAP file, complete or cut off, that finds every message in it."""

from __future__ import annotations

import mmap
import struct
import zlib
from collections.abc import Iterator
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np
from rosbags.rosbag2.storage_mcap import DECOMPRESSORS

MAGIC = b"\x89MCAP0\r\n"
FOOTER, SCHEMA, CHANNEL, MESSAGE, CHUNK, MESSAGE_INDEX = 0x02, 0x03, 0x04, 0x05, 0x06, 0x07
DATA_END = 0x0F
CUT_CHUNK = -1  # not in the file format: a chunk record whose end is missing
RECORD_HEAD = 9
PAYLOAD = 31  # from a message record's start to its payload
LOG_TIME = 15

_head = struct.Struct("<BQ").unpack_from
_chunk_head = struct.Struct("<QQQI").unpack_from
_u16 = struct.Struct("<H").unpack_from
_u32 = struct.Struct("<I").unpack_from
_u64 = struct.Struct("<Q").unpack_from


@dataclass(frozen=True)
class Channel:
    """One channel: topic, its type, and the definition text that the file carries."""

    topic: str
    msgtype: str
    definition: str
    encoding: str


@dataclass
class Block:
    """Uncompressed bytes with the offsets of the message records in them, per channel."""

    data: memoryview
    offsets: dict[int, np.ndarray]


@dataclass
class Scan:
    """What a pass over the file found. `damage` is empty for a complete file."""

    channels: dict[int, Channel] = field(default_factory=dict)
    blocks: list[Block] = field(default_factory=list)
    damage: list[str] = field(default_factory=list)
    schemas: dict[int, tuple[str, str]] = field(default_factory=dict)
    finished: bool = False

    @property
    def message_count(self) -> int:
        """Number of messages found."""
        return sum(len(o) for block in self.blocks for o in block.offsets.values())


def scan(data: memoryview) -> Scan:
    """Find all messages in an MCAP file given as its bytes.

    Never raises on damage: what is whole is returned, the rest is told in `damage`.
    Raises ValueError if the file is no MCAP file at all.
    """
    head = data[: len(MAGIC)].tobytes()
    if not MAGIC.startswith(head):
        raise ValueError("no MCAP file: its first bytes are not MCAP's")
    found = Scan()
    loose: dict[int, list[int]] = {}
    pending: _Chunk | None = None
    for op, start, body, end in _records(data, len(MAGIC), found):
        if op == MESSAGE_INDEX:
            if pending:
                pending.take_index(data[body:end])
            continue
        if pending:
            pending.finish(found)
            pending = None
        if op == CHUNK:
            pending = _open_chunk(data, start, body, end, found)
        elif op == CUT_CHUNK:
            _salvage(data[body:end], found)
        elif op == MESSAGE:
            loose.setdefault(_u16(data, body)[0], []).append(start)
        elif op == DATA_END:
            break
        else:
            _define(op, data[body:end], found)
    if pending:
        pending.finish(found)
    if loose:
        found.blocks.append(Block(data, {c: np.array(o) for c, o in loose.items()}))
    found.finished = not found.damage and data[-len(MAGIC) :].tobytes() == MAGIC
    if not found.finished and not found.damage:
        found.damage.append("the file's end is missing")
    return found


def _records(data: memoryview, position: int, found: Scan) -> Iterator[tuple[int, int, int, int]]:
    """Yield (op, start, body, end) of whole records, and of a chunk that is cut off at the end."""
    size = len(data)
    while position < size:
        if position + RECORD_HEAD > size:
            found.damage.append(f"cut off at byte {size}, in a record's head")
            return
        op, length = _head(data, position)
        body = position + RECORD_HEAD
        end = body + length
        if end > size:
            found.damage.append(f"cut off at byte {size}, {end - size} bytes short of a record")
            if op == CHUNK:
                yield CUT_CHUNK, position, body, size
            return
        yield op, position, body, end
        if op == FOOTER:
            return
        position = end


class _Chunk:
    """A chunk whose message indexes follow it."""

    def __init__(self, content: memoryview) -> None:
        self.content = content
        self.index: dict[int, np.ndarray] = {}

    def take_index(self, body: memoryview) -> None:
        (channel,) = _u16(body, 0)
        (size,) = _u32(body, 2)
        if size <= len(body) - 6 and size % 16 == 0:
            self.index[channel] = np.frombuffer(body[6 : 6 + size], "<u8")[1::2]

    def finish(self, found: Scan) -> None:
        offsets = self._checked_index(found)
        if offsets is None:
            offsets, _ = walk(self.content, found)
        if offsets:
            found.blocks.append(Block(self.content, offsets))

    def _checked_index(self, found: Scan) -> dict[int, np.ndarray] | None:
        """Index offsets, if they name every record from the first message to the chunk's end."""
        if not self.index:
            return None
        offsets = {c: o.astype(np.int64) for c, o in self.index.items() if len(o)}
        every = np.sort(np.concatenate(list(offsets.values()))) if offsets else np.empty(0, int)
        if not len(every) or every[-1] + PAYLOAD > len(self.content):
            return None
        sizes = gather(self.content, every + 1, np.dtype("<u8")).astype(np.int64)
        ends = np.append(every[1:], len(self.content))
        if not np.array_equal(every + RECORD_HEAD + sizes, ends):
            return None
        _, whole = walk(self.content[: every[0]], found)
        return offsets if whole else None


def _open_chunk(data: memoryview, start: int, body: int, end: int, found: Scan) -> _Chunk | None:
    """Decompress and check a whole chunk record."""
    try:
        _, _, size, checksum = _chunk_head(data, body)
        name, position = _text(data, body + 28)
        (stored,) = _u64(data, position)
        packed = data[position + 8 : position + 8 + stored]
        content = _decompress(name, packed)
        intact = len(content) == size and (not checksum or zlib.crc32(content) == checksum)
    except Exception:  # decompressors raise whatever they like on damaged bytes
        intact = False
    if not intact:
        found.damage.append(f"the chunk at byte {start} is damaged and was left out")
        return None
    return _Chunk(content)


def _salvage(rest: memoryview, found: Scan) -> None:
    """Messages of a chunk whose end is missing: those before the cut, if not compressed."""
    if len(rest) < 32:
        return
    (name_size,) = _u32(rest, 28)
    if name_size or len(rest) < 40:
        return
    content = rest[40:]
    offsets, _ = walk(content, found)
    if offsets:
        found.blocks.append(Block(content, offsets))


def walk(content: memoryview, found: Scan) -> tuple[dict[int, np.ndarray], bool]:
    """Message offsets of a chunk, record by record; False if it does not end with a record."""
    offsets: dict[int, list[int]] = {}
    position, size = 0, len(content)
    while position + RECORD_HEAD <= size:
        op, length = _head(content, position)
        end = position + RECORD_HEAD + length
        if end > size:
            break
        if op == MESSAGE and length >= PAYLOAD - RECORD_HEAD:
            offsets.setdefault(_u16(content, position + RECORD_HEAD)[0], []).append(position)
        else:
            _define(op, content[position + RECORD_HEAD : end], found)
        position = end
    return {c: np.array(o, dtype=np.int64) for c, o in offsets.items()}, position == size


def _define(op: int, body: memoryview, found: Scan) -> None:
    """Take a schema or a channel record; anything else is not needed for reading."""
    if op == SCHEMA:
        (key,) = _u16(body, 0)
        name, position = _text(body, 2)
        _, position = _text(body, position)
        text, _ = _text(body, position)
        found.schemas[key] = (name, text)
    elif op == CHANNEL:
        (key,) = _u16(body, 0)
        name, text = found.schemas.get(_u16(body, 2)[0], ("", ""))
        topic, position = _text(body, 4)
        encoding, _ = _text(body, position)
        found.channels[key] = Channel(topic, name, text, encoding)


def _text(data: memoryview, position: int) -> tuple[str, int]:
    (size,) = _u32(data, position)
    end = position + 4 + size
    return data[position + 4 : end].tobytes().decode("utf-8", "replace"), end


def _decompress(name: str, packed: memoryview) -> memoryview:
    if not name:
        return packed
    return memoryview(DECOMPRESSORS[name](packed.tobytes(), 0))


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
