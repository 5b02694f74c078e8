"""rosbags' MCAP storage with a cheap append and chunks that reach the disk as the run goes.

rosbags writes the file's format; what differs here is only the hot path: a message costs about
a microsecond, a chunk carries its checksum and its index, and it is on disk when it is closed. The
file's data and its summary have checksums as well.
"""

from __future__ import annotations

import struct
import zlib
from array import array
from collections.abc import Mapping
from io import BytesIO
from pathlib import Path

import numpy as np
from rosbags.interfaces import Connection
from rosbags.rosbag2 import Writer
from rosbags.rosbag2.enums import CompressionMode, StoragePlugin
from rosbags.rosbag2.storage_mcap import McapWriter

from steering_bringup.bags.append_file import AppendFile
from steering_bringup.bags.file_end import FileEnd

DISTRIBUTION = "jazzy"
"""Of ROS 2, whose message definitions the bench's are; other tools look types up by it."""

MESSAGE, CHUNK, MESSAGE_INDEX = 0x05, 0x06, 0x07
MESSAGE_PREFIX = struct.Struct("<BQHIQQ")
MESSAGE_FIELDS = 22  # bytes of a message record between its length and its payload

_PREFIX_ROW = np.dtype(
    [("op", "u1"), ("size", "<u8"), ("channel", "<u2"), ("sequence", "<u4"), ("log", "<u8"),
     ("publish", "<u8")]
)  # fmt: skip


class FlushedMcap(McapWriter):
    """MCAP storage whose closed chunks are on disk; the file holds whole chunks only."""

    def __init__(self, path: Path, compression: CompressionMode) -> None:
        super().__init__(path, compression)
        self.bio.close()
        self.file = AppendFile(self.path)
        self.bio = self.file  # type: ignore[assignment]
        self.index: dict[int, array[int]] = {}
        self.last_stamp: int | None = None

    def add_connection(self, connection: Connection, offered_qos_profiles: str) -> None:
        """Announce a channel in the open chunk."""
        super().add_connection(connection, offered_qos_profiles)
        self.index[connection.id] = array("Q")

    def append(self, channel: int, stamp: int, data: bytes | memoryview) -> int:
        """Add one message to the open chunk; return the chunk's size in bytes."""
        bio = self.chunk.bio
        offset = bio.tell()
        size = len(data)
        bio.write(MESSAGE_PREFIX.pack(MESSAGE, MESSAGE_FIELDS + size, channel, 0, stamp, stamp))
        bio.write(data)
        self.index[channel].extend((stamp, offset))
        return offset + MESSAGE_PREFIX.size + size

    def append_block(self, stamps: np.ndarray, payloads: Mapping[int, np.ndarray]) -> int:
        """Add n messages of each channel, interleaved by row; return the chunk's size in bytes.

        `stamps`: (n,) ns. `payloads`: channel -> (n, size) uint8, in the order within a row.
        """
        start = self.chunk.bio.tell()
        count = len(stamps)
        parts: list[np.ndarray] = []
        columns: dict[int, int] = {}
        width = 0
        for channel, rows in payloads.items():
            prefix = np.zeros(count, _PREFIX_ROW)
            prefix["op"], prefix["size"] = MESSAGE, MESSAGE_FIELDS + rows.shape[1]
            prefix["channel"], prefix["log"], prefix["publish"] = channel, stamps, stamps
            parts += [prefix.view(np.uint8).reshape(count, -1), rows]
            columns[channel] = width
            width += MESSAGE_PREFIX.size + rows.shape[1]
        self.chunk.bio.write(np.hstack(parts).tobytes())
        entries = np.empty((count, 2), "<u8")
        entries[:, 0] = stamps
        for channel, column in columns.items():
            entries[:, 1] = start + column + width * np.arange(count)
            self.index[channel].frombytes(entries.tobytes())
        return self.chunk.bio.tell()

    def write(self, connection: Connection, timestamp: int, data: bytes | memoryview) -> None:
        """Write one message (the interface of rosbags' own writer)."""
        self.append(connection.id, timestamp, data)

    def close(self, version: int, metadata: str) -> None:
        """Write index and summary; the metadata go into the file as well."""
        if self.chunk.bio.tell():
            self.close_chunk()
        end = FileEnd(self.file.tell())
        self.bio = end  # type: ignore[assignment]
        super().close(version, _of_distribution(metadata))
        self.bio = self.file  # type: ignore[assignment]
        self.file.write(end.with_checksums(self.file.checksum))
        self.file.close()

    def discard_chunk(self) -> None:
        """Forget what is not on disk yet."""
        self.chunk.bio = BytesIO()
        self.index = {channel: array("Q") for channel in self.index}

    def close_chunk(self) -> None:
        """Put the open chunk and its index on disk, or nothing of it (OSError)."""
        content = self.chunk.bio.getvalue()
        index, self.index = self.index, {channel: array("Q") for channel in self.index}
        self.chunk.bio = BytesIO()
        entries = {c: np.frombuffer(v, "<u8").reshape(-1, 2) for c, v in index.items() if v}
        first, last = _time_range(entries)
        summary = self._write_chunk(content, entries, first, last)
        self.bio.flush()
        self.chunks.append(summary)
        for channel, rows in entries.items():
            self.channel_stats[channel] += len(rows)
        if entries:
            self.message_start_time = min(self.message_start_time, first)
            self.message_end_time = max(self.message_end_time, last)
            self.last_stamp = self.message_end_time

    def _write_chunk(
        self, content: bytes, entries: Mapping[int, np.ndarray], first: int, last: int
    ) -> BytesIO:
        """Write chunk and message indexes; return the body of its chunk index record."""
        name = self.compression.encode()
        body = self.compressor(content)
        start = self.bio.tell()
        head = struct.pack("<QQQII", first, last, len(content), zlib.crc32(content), len(name))
        head += name + struct.pack("<Q", len(body))
        self.bio.write(struct.pack("<BQ", CHUNK, len(head) + len(body)))
        self.bio.write(head)
        self.bio.write(body)
        end = self.bio.tell()
        places = b""
        for channel, rows in entries.items():
            places += struct.pack("<HQ", channel, self.bio.tell())
            data = rows.tobytes()
            self.bio.write(
                struct.pack("<BQHI", MESSAGE_INDEX, 6 + len(data), channel, len(data)) + data
            )
        summary = BytesIO()
        summary.write(struct.pack("<QQQQI", first, last, start, end - start, len(places)))
        summary.write(places + struct.pack("<QI", self.bio.tell() - end, len(name)) + name)
        summary.write(struct.pack("<QQ", len(body), len(content)))
        return summary


def _time_range(entries: Mapping[int, np.ndarray]) -> tuple[int, int]:
    """First and last stamp of a chunk; zeros for a chunk without messages."""
    if not entries:
        return 0, 0
    first = min(int(rows[:, 0].min()) for rows in entries.values())
    return first, max(int(rows[:, 0].max()) for rows in entries.values())


class FlushedWriter(Writer):
    """rosbags' rosbag2 writer on the flushed storage."""

    def __init__(self, path: Path) -> None:
        super().__init__(path, version=9, storage_plugin=StoragePlugin.MCAP)
        self.STORAGE_PLUGINS = {StoragePlugin.MCAP: FlushedMcap}

    def close(self) -> None:
        """Write index and metadata, which name the distribution whose messages these are."""
        super().close()
        new = self.metapath.with_suffix(".yaml.new")
        new.write_text(_of_distribution(self.metapath.read_text("utf-8")), "utf-8")
        new.replace(self.metapath)


def _of_distribution(metadata: str) -> str:
    return metadata.replace("ros_distro: rosbags", f"ros_distro: {DISTRIBUTION}", 1)
