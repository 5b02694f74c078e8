"""What an MCAP file holds, found chunk by chunk; damaged parts are left out and told."""

from __future__ import annotations

import struct
import zlib
from dataclasses import dataclass, field

import numpy as np
from rosbags.rosbag2.storage_mcap import DECOMPRESSORS

from steering_bringup.bags import mcap_bytes as mcap
from steering_bringup.bags.mcap_bytes import gather, text_at, u16, u32, u64


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


class Chunk:
    """A chunk whose message indexes follow it."""

    def __init__(self, content: memoryview) -> None:
        self.content = content
        self.index: dict[int, np.ndarray] = {}

    def take_index(self, body: memoryview) -> None:
        """Take the record that names the places of one channel's messages."""
        if len(body) < 6:
            return
        (channel,) = u16(body, 0)
        (size,) = u32(body, 2)
        if size <= len(body) - 6 and size % 16 == 0:
            self.index[channel] = np.frombuffer(body[6 : 6 + size], "<u8")[1::2]

    def finish(self, found: Scan) -> None:
        """Give the chunk's messages to the scan."""
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
        if not len(every) or every[0] < 0 or every[-1] > len(self.content) - mcap.PAYLOAD:
            return None
        sizes = gather(self.content, every + 1, np.dtype("<u8")).astype(np.int64)
        ends = np.append(every[1:], len(self.content))
        if not np.array_equal(every + mcap.RECORD_HEAD + sizes, ends):
            return None
        channel_type = np.dtype("<u2")
        for channel, own in offsets.items():
            if np.any(gather(self.content, own + mcap.RECORD_HEAD, channel_type) != channel):
                return None
        _, whole = walk(self.content[: every[0]], found)
        return offsets if whole else None


def open_chunk(data: memoryview, start: int, body: int, end: int, found: Scan) -> Chunk | None:
    """Decompress and check a whole chunk record."""
    try:
        _, _, size, checksum = mcap.chunk_head(data, body)
        name, position = text_at(data, body + 28)
        (stored,) = u64(data, position)
        packed = data[position + 8 : position + 8 + stored]
        content = _decompress(name, packed)
        intact = len(content) == size and (not checksum or zlib.crc32(content) == checksum)
    except Exception:  # decompressors raise whatever they like on damaged bytes
        intact = False
    if not intact:
        found.damage.append(f"the chunk at byte {start} is damaged and was left out")
        return None
    return Chunk(content)


def salvage(rest: memoryview, found: Scan) -> None:
    """Messages of a chunk whose end is missing: those before the cut, if not compressed."""
    if len(rest) < 32:
        return
    (name_size,) = u32(rest, 28)
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
    while position + mcap.RECORD_HEAD <= size:
        op, length = mcap.head(content, position)
        end = position + mcap.RECORD_HEAD + length
        if end > size:
            break
        if op == mcap.MESSAGE and length >= mcap.PAYLOAD - mcap.RECORD_HEAD:
            offsets.setdefault(u16(content, position + mcap.RECORD_HEAD)[0], []).append(position)
        else:
            define(op, content[position + mcap.RECORD_HEAD : end], found)
        position = end
    return {c: np.array(o, dtype=np.int64) for c, o in offsets.items()}, position == size


def define(op: int, body: memoryview, found: Scan) -> None:
    """Take a schema or a channel record; anything else is not needed for reading."""
    try:
        _define(op, body, found)
    except struct.error:
        found.damage.append("a damaged definition was left out")


def _define(op: int, body: memoryview, found: Scan) -> None:
    if op == mcap.SCHEMA:
        (key,) = u16(body, 0)
        name, position = text_at(body, 2)
        _, position = text_at(body, position)
        text, _ = text_at(body, position)
        found.schemas[key] = (name, text)
    elif op == mcap.CHANNEL:
        (key,) = u16(body, 0)
        name, text = found.schemas.get(u16(body, 2)[0], ("", ""))
        topic, position = text_at(body, 4)
        encoding, _ = text_at(body, position)
        found.channels[key] = Channel(topic, name, text, encoding)


def _decompress(name: str, packed: memoryview) -> memoryview:
    if not name:
        return packed
    return memoryview(DECOMPRESSORS[name](packed.tobytes(), 0))
