"""MCAP files, complete or cut off: every whole message, in order of time."""

from __future__ import annotations

from collections.abc import Collection, Iterator, Sequence
from pathlib import Path

import numpy as np

from steering_bringup.bags.append_file import is_being_written
from steering_bringup.bags.errors import BagError
from steering_bringup.bags.mcap_bytes import LOG_TIME, PAYLOAD, gather, map_file
from steering_bringup.bags.scan import Block, Scan, scan
from steering_bringup.playback.source import Message, TopicInfo

PORTION = 8192
"""Messages whose places are turned into Python numbers at once."""


COLUMNS = (np.int64, np.int32, np.int64, np.int32, np.int32)
"""Of stamp, block, offset in it, size and topic of each message."""


class McapSource:
    """The messages stay in their files; their places are sorted by time in memory."""

    def __init__(self, files: Sequence[Path], durable: Collection[str] = ()) -> None:
        self.topics: dict[str, TopicInfo] = {}
        self.notes: list[str] = []
        self._blocks: list[Block] = []
        self._names: list[str] = []
        parts: list[tuple[np.ndarray, ...]] = [tuple(np.empty(0, kind) for kind in COLUMNS)]
        for file in files:
            found = _scan(file)
            self._note(file, found)
            numbers = self._announce(found, durable)
            parts += [part for block in found.blocks for part in self._places(block, numbers)]
        columns = [np.concatenate(column) for column in zip(*parts, strict=True)]
        stamps, blocks, offsets, sizes, topics = columns
        order = np.lexsort((offsets, blocks, stamps))
        self._stamps, self._topic_of = stamps[order], topics[order]
        self._block_of, self._offsets, self._sizes = blocks[order], offsets[order], sizes[order]
        self._count()
        self.start = int(self._stamps[0]) if len(order) else 0
        self.end = int(self._stamps[-1]) if len(order) else 0

    def messages(self, topics: Collection[str], start: int, stop: int) -> Iterator[Message]:
        """Yield the messages of ``topics`` from ``start`` to before ``stop`` in order of time."""
        first, last = np.searchsorted(self._stamps, (start, stop))
        wanted = np.array([name in topics for name in self._names], bool)
        for begin in range(first, last, PORTION):
            rows = np.arange(begin, min(begin + PORTION, last))
            rows = rows[wanted[self._topic_of[rows]]]
            columns = (self._stamps, self._topic_of, self._block_of, self._offsets, self._sizes)
            for stamp, topic, block, at, size in zip(
                *(column[rows].tolist() for column in columns), strict=True
            ):
                yield stamp, self._names[topic], self._blocks[block].data[at : at + size].tobytes()

    def close(self) -> None:
        """Let go of the files."""
        self._blocks.clear()

    def _announce(self, found: Scan, durable: Collection[str]) -> dict[int, int]:
        """Take a file's channels; return the number of each channel's topic."""
        numbers = {}
        for key, channel in found.channels.items():
            name = channel.topic
            if name not in self.topics:
                self._names.append(name)
                self.topics[name] = TopicInfo(
                    channel.msgtype, 0, channel.encoding, channel.definition, name in durable
                )
            elif self.topics[name].msgtype != channel.msgtype:
                self.notes.append(f"{name} has messages of type {channel.msgtype} too: left out")
                continue
            numbers[key] = self._names.index(name)
        return numbers

    def _places(self, block: Block, numbers: dict[int, int]) -> Iterator[tuple[np.ndarray, ...]]:
        """Yield (stamps, block, offsets, sizes, topic) of each channel's messages in a block."""
        self._blocks.append(block)
        for channel, offsets in block.offsets.items():
            if channel not in numbers:
                continue
            stamps = gather(block.data, offsets + LOG_TIME, np.dtype("<i8"))
            sizes = gather(block.data, offsets + 1, np.dtype("<u8")).astype(np.int32) - 22
            here = np.full(len(offsets), len(self._blocks) - 1, np.int32)
            topic = np.full(len(offsets), numbers[channel], np.int32)
            yield stamps, here, offsets + PAYLOAD, sizes, topic

    def _count(self) -> None:
        counts = np.bincount(self._topic_of, minlength=len(self._names)).tolist()
        for name, count in zip(self._names, counts, strict=True):
            info = self.topics[name]
            self.topics[name] = TopicInfo(
                info.msgtype, count, info.encoding, info.definition, info.durable
            )

    def _note(self, file: Path, found: Scan) -> None:
        if found.damage and is_being_written(file):
            self.notes.append(f"{file.name} is still being written: what is there is played")
        elif found.damage:
            text = "; ".join(found.damage)
            self.notes.append(
                f"{file.name} is not complete ({text}): its {found.message_count} whole messages "
                "are played; 'steer recover' repairs a bag"
            )


def _scan(file: Path) -> Scan:
    try:
        return scan(map_file(file))
    except (OSError, ValueError) as error:
        raise BagError(f"'{file}' cannot be read: {error}") from error
