"""Where played messages come from: one interface over MCAP, SQLite and whatever rosbags reads."""

from __future__ import annotations

from collections.abc import Collection, Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Protocol

from steering_bringup.bags.errors import BagError
from steering_bringup.bags.places import METADATA_FILE
from steering_bringup.playback.metadata import compressed, durable_topics

Message = tuple[int, str, bytes]
"""Recording time in ns, topic, serialised bytes."""

STREAM_BYTES = 1 << 31
"""MCAP bags beyond this are streamed; below, the places of all messages are held in memory."""


@dataclass(frozen=True)
class TopicInfo:
    """A topic of a bag. ``definition``: the message's text, where the bag has it as .msg text.

    ``durable``: its publisher kept the last message for late subscribers (transient local).
    """

    msgtype: str
    count: int
    encoding: str = "cdr"
    definition: str = ""
    durable: bool = False


class Source(Protocol):
    """A bag opened for playing. ``start`` and ``end``: ns of its first and last message.

    ``notes``: damage, and what else the listener should know.
    """

    topics: dict[str, TopicInfo]
    start: int
    end: int
    notes: list[str]

    def messages(self, topics: Collection[str], start: int, stop: int) -> Iterator[Message]:
        """Yield the messages of ``topics`` from ``start`` to before ``stop`` in order of time."""

    def close(self) -> None:
        """Let go of the bag's files."""


def open_source(path: Path) -> Source:
    """Open a bag: a folder, or one .mcap or .db3 file, complete or cut off.

    Raises BagError, naming the path, if there is nothing to play.
    """
    if not path.exists():
        raise BagError(f"there is no bag '{path}'")
    source = _open(path)
    if not any(info.count for info in source.topics.values()):
        source.close()
        raise BagError(f"'{path}' holds no message")
    return source


def _open(path: Path) -> Source:
    folder = path if path.is_dir() else path.parent
    durable = durable_topics(folder / METADATA_FILE)
    mcap, sqlite = (_files(path, suffix) for suffix in (".mcap", ".db3"))
    large = sum(file.stat().st_size for file in mcap) > STREAM_BYTES
    if path.is_dir() and (compressed(path / METADATA_FILE) or large):
        from steering_bringup.playback.rosbags_source import RosbagsSource

        return RosbagsSource(path, durable)
    if mcap:
        from steering_bringup.playback.mcap_source import McapSource

        return McapSource(mcap, durable)
    if sqlite:
        from steering_bringup.playback.sqlite_source import SqliteSource

        return SqliteSource(sqlite, durable)
    if path.suffix == ".bag":
        raise BagError(f"'{path}' is a bag of ROS 1: rosbags-convert makes one of ROS 2 of it")
    raise BagError(f"'{path}' is no bag: it holds no .mcap or .db3 file")


def _files(path: Path, suffix: str) -> list[Path]:
    """Return the bag's files of a kind, in the order in which they were recorded."""
    if path.is_file():
        return [path] if path.suffix == suffix else []

    def number(file: Path) -> tuple[int, str]:
        last = file.stem.rpartition("_")[2]
        return (int(last) if last.isdigit() else 0, file.name)

    return sorted(path.glob(f"*{suffix}"), key=number)
