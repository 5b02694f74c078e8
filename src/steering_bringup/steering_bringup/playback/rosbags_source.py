"""Bags that rosbag2 has compressed, and very large ones: streamed through rosbags."""

from __future__ import annotations

from collections.abc import Collection, Iterator
from pathlib import Path

from rosbags.interfaces import MessageDefinitionFormat
from rosbags.rosbag2 import Reader, ReaderError

from steering_bringup.bags.errors import BagError
from steering_bringup.playback.source import Message, TopicInfo


class RosbagsSource:
    """One pass over the files each time that messages are asked for."""

    def __init__(self, path: Path, durable: Collection[str] = ()) -> None:
        self.notes: list[str] = []
        self.topics: dict[str, TopicInfo] = {}
        try:
            self._reader = Reader(path)
            self._reader.open()
        except (ReaderError, OSError, AssertionError) as error:
            raise BagError(f"'{path}' cannot be read: {error}") from error
        for connection in self._reader.connections:
            known = self.topics.get(connection.topic)
            count = connection.msgcount + (known.count if known else 0)
            definition = connection.msgdef
            text = definition.data if definition.format == MessageDefinitionFormat.MSG else ""
            encoding = getattr(connection.ext, "serialization_format", "cdr")
            self.topics[connection.topic] = TopicInfo(
                connection.msgtype, count, encoding, text, connection.topic in durable
            )
        self.start = self._reader.start_time
        self.end = self._reader.end_time - 1

    def messages(self, topics: Collection[str], start: int, stop: int) -> Iterator[Message]:
        """Yield the messages of ``topics`` from ``start`` to before ``stop`` in order of time."""
        chosen = [c for c in self._reader.connections if c.topic in topics]
        for connection, stamp, data in self._reader.messages(chosen, start, stop):
            yield stamp, connection.topic, bytes(data)

    def close(self) -> None:
        """Close the files, and remove unpacked ones."""
        self._reader.close()
