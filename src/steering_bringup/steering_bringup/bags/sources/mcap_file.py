"""An MCAP file, complete or cut off: every whole message, in order of time."""

from __future__ import annotations

from collections import deque
from collections.abc import Collection, Iterator
from pathlib import Path

import numpy as np

from steering_bringup.bags.append_file import is_being_written
from steering_bringup.bags.chunks import Channel
from steering_bringup.bags.errors import BagError
from steering_bringup.bags.mcap_bytes import LOG_TIME, PAYLOAD, gather, map_file
from steering_bringup.bags.scan import Block, Scan, scan
from steering_bringup.bags.sources.spans import Span, spans_of

PORTION = 8192
"""Messages whose places are turned into Python numbers at once."""

UNPACKED = 8
"""Chunks that are kept unpacked: messages in order of time take turns between a few."""

COLUMNS = (np.int64, np.int32, np.int64, np.int32, np.int32)
"""Of stamp, block, offset in it, size and channel of each message."""


class McapFile:
    """The messages stay in the file; their places (28 bytes each) are sorted by time in memory."""

    def __init__(self, path: Path) -> None:
        try:
            found = scan(map_file(path))
        except (OSError, ValueError) as error:
            raise BagError(f"'{path}' cannot be read: {error}") from error
        self.path = path
        self.channels: dict[int, Channel] = dict(found.channels)
        self.notes: list[str] = []
        self._note(path, found)
        self._blocks = found.blocks
        self._unpacked: deque[Block] = deque()
        parts: list[tuple[np.ndarray, ...]] = [tuple(np.empty(0, kind) for kind in COLUMNS)]
        for number, block in enumerate(found.blocks):
            parts += self._places(number, block)
            block.release()
        columns = [np.concatenate(column) for column in zip(*parts, strict=True)]
        stamps, blocks, offsets, sizes, channels = columns
        order = np.lexsort((offsets, blocks, stamps))
        self._stamps, self._channel_of = stamps[order], channels[order]
        self._block_of, self._offsets, self._sizes = blocks[order], offsets[order], sizes[order]
        keys, counts = np.unique(channels, return_counts=True)
        self.counts = dict(zip(keys.tolist(), counts.tolist(), strict=True))
        self.spans: list[Span] = spans_of(self._stamps)

    def messages(
        self, keys: Collection[int], first: int, last: int
    ) -> Iterator[tuple[int, int, bytes]]:
        """Yield (stamp, channel, bytes) of channels ``keys`` in order of time."""
        start = int(np.searchsorted(self._stamps, first, "left"))
        stop = int(np.searchsorted(self._stamps, last, "right"))
        wanted = np.array(sorted(keys), np.int32)
        for begin in range(start, stop, PORTION):
            rows = np.arange(begin, min(begin + PORTION, stop))
            rows = rows[np.isin(self._channel_of[rows], wanted)]
            columns = (self._stamps, self._channel_of, self._block_of, self._offsets, self._sizes)
            for stamp, key, block, at, size in zip(
                *(column[rows].tolist() for column in columns), strict=True
            ):
                yield stamp, key, self._data(self._blocks[block])[at : at + size].tobytes()

    def close(self) -> None:
        """Let go of the file."""
        self._blocks = []
        self._unpacked.clear()

    def _data(self, block: Block) -> memoryview:
        if block.content is None:
            if len(self._unpacked) == UNPACKED:
                self._unpacked.popleft().release()
            self._unpacked.append(block)
        return block.data

    def _places(self, number: int, block: Block) -> Iterator[tuple[np.ndarray, ...]]:
        """Yield (stamps, block, offsets, sizes, channel) of each channel's messages in a block."""
        for key, offsets in block.offsets.items():
            if key not in self.channels:
                self.notes.append(
                    f"{self.path.name}: {len(offsets)} messages of a channel that is not defined "
                    "are left out"
                )
                continue
            stamps = gather(block.data, offsets + LOG_TIME, np.dtype("<i8"))
            sizes = gather(block.data, offsets + 1, np.dtype("<u8")).astype(np.int32) - 22
            here = np.full(len(offsets), number, np.int32)
            yield stamps, here, offsets + PAYLOAD, sizes, np.full(len(offsets), key, np.int32)

    def _note(self, path: Path, found: Scan) -> None:
        if found.damage and is_being_written(path):
            self.notes.append(f"{path.name} is still being written: what is there is read")
        elif found.damage:
            self.notes.append(
                f"{path.name} is not complete ({'; '.join(found.damage)}): its "
                f"{found.message_count} whole messages are there; 'steer recover' repairs a bag"
            )
