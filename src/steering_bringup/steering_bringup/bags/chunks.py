"""What an MCAP file holds, found chunk by chunk; damaged parts are left out and told."""

from __future__ import annotations

import struct
import zlib
from collections.abc import Iterator
from dataclasses import dataclass, field, replace

import numpy as np
import zstandard
from rosbags.rosbag2.storage_mcap import DECOMPRESSORS

from steering_bringup.bags import mcap_bytes as mcap
from steering_bringup.bags.mcap_bytes import gather, text_at, u16, u32, u64

QOS_KEY, HASH_KEY = "offered_qos_profiles", "topic_type_hash"
"""Names under which rosbag2 tells more about a channel."""

NUMBERS = 1 << 16
"""Channels have numbers of 16 bits."""


@dataclass(frozen=True)
class Channel:
    """One channel: topic, its type, and the definition text that the file carries.

    ``qos``: the publishers' offered profiles as YAML text; ``digest``: the type's hash; both where
    the file tells them.
    """

    topic: str
    msgtype: str
    definition: str
    encoding: str
    qos: str = ""
    digest: str = ""


@dataclass
class Block:
    """The bytes of a chunk with the offsets of the message records in them, per channel.

    ``content``: uncompressed; None where it is to be unpacked (``packed``: how, and what) when it
    is asked for.
    """

    content: memoryview | None
    offsets: dict[int, np.ndarray]
    packed: tuple[str, memoryview] | None = None

    @property
    def data(self) -> memoryview:
        """The uncompressed bytes; kept until they are released."""
        if self.content is None:
            assert self.packed is not None
            self.content = _decompress(*self.packed)
        return self.content

    def release(self) -> None:
        """Let go of what can be unpacked again."""
        if self.packed is not None:
            self.content = None


@dataclass
class Scan:
    """What a pass over the file found. `damage` is empty for a complete file.

    ``channels``: by a key of the pass, which is the file's number of the channel unless a file
    uses a number twice; ``current``: number -> key of those that follow.
    """

    channels: dict[int, Channel] = field(default_factory=dict)
    blocks: list[Block] = field(default_factory=list)
    damage: list[str] = field(default_factory=list)
    schemas: dict[int, tuple[str, str]] = field(default_factory=dict)
    finished: bool = False
    current: dict[int, int] = field(default_factory=dict)

    def add_channel(self, number: int, channel: Channel) -> None:
        """Take a definition: most repeat what is known; another one of a used number is told."""
        key = number
        while (known := self.channels.get(key)) not in (None, channel):
            if known == replace(channel, msgtype="", definition=""):
                break  # its schema came late
            key += NUMBERS
        if known is None and key != number:
            self.damage.append(f"channel {number} is {channel.topic} too")
        self.channels[key] = channel
        self.current[number] = key

    @property
    def message_count(self) -> int:
        """Number of messages found."""
        return sum(len(o) for block in self.blocks for o in block.offsets.values())


class Chunk:
    """A chunk whose message indexes follow it."""

    def __init__(self, content: memoryview, packed: tuple[str, memoryview] | None) -> None:
        self.content = content
        self.packed = packed
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
        else:
            offsets = {found.current.get(number, number): o for number, o in offsets.items()}
        if offsets:
            block = Block(self.content, offsets, self.packed)
            block.release()
            found.blocks.append(block)

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
        if name and name not in DECOMPRESSORS:
            found.damage.append(f"the chunk at byte {start} is packed as {name[:9]!a}: left out")
            return None
        content = _decompress(name, packed)
        intact = len(content) == size and (not checksum or zlib.crc32(content) == checksum)
    except Exception:  # decompressors raise whatever they like on damaged bytes
        intact = False
    if not intact:
        found.damage.append(f"the chunk at byte {start} is damaged and was left out")
        return None
    return Chunk(content, (name, packed) if name else None)


def salvage(rest: memoryview, found: Scan) -> None:
    """Take the messages of a chunk whose end is missing: those that are whole before the cut."""
    try:
        name, position = text_at(rest, 28)
        content = rest[position + 8 :]
        if name:
            content = _beginning(name, content)
    except Exception:  # cut in its head, or damaged as well
        return
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
            (number,) = u16(content, position + mcap.RECORD_HEAD)
            offsets.setdefault(found.current.get(number, number), []).append(position)
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
        (number,) = u16(body, 0)
        name, text = found.schemas.get(u16(body, 2)[0], ("", ""))
        topic, position = text_at(body, 4)
        encoding, position = text_at(body, position)
        more = dict(_pairs(body, position))
        qos, digest = more.get(QOS_KEY, ""), more.get(HASH_KEY, "")
        found.add_channel(number, Channel(topic, name, text, encoding, qos, digest))


def _pairs(body: memoryview, position: int) -> Iterator[tuple[str, str]]:
    """Yield the entries of a map of texts."""
    (size,) = u32(body, position)
    position += 4
    end = position + size
    while position < end:
        key, position = text_at(body, position)
        value, position = text_at(body, position)
        yield key, value


def _beginning(name: str, packed: memoryview) -> memoryview:
    """Return the blocks that are whole in a chunk without its end; none where it is no zstd."""
    if name != "zstd":
        return memoryview(b"")
    return memoryview(zstandard.ZstdDecompressor().decompressobj().decompress(packed.tobytes()))


def _decompress(name: str, packed: memoryview) -> memoryview:
    if not name:
        return packed
    return memoryview(DECOMPRESSORS[name](packed.tobytes(), 0))
