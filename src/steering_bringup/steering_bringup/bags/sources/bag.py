"""A bag of any origin, opened for reading: its topics, and its messages in order of time."""

from __future__ import annotations

from collections.abc import Collection, Iterator
from dataclasses import dataclass
from heapq import merge
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Protocol

from steering_bringup.bags.chunks import Channel
from steering_bringup.bags.errors import BagError
from steering_bringup.bags.sources.files import OF_ROS1, BagFiles, bag_files, kind_of
from steering_bringup.bags.sources.packed import ZSTD, unpack_file, unpack_message
from steering_bringup.bags.sources.spans import Span, joined
from steering_bringup.bags.sources.topics import Topics

Message = tuple[int, str, bytes]
"""Recording time in ns, topic, serialised bytes."""

EARLIEST, LATEST = -(1 << 63), 1 << 63
CDR_KINDS = frozenset(bytes((0, kind)) for kind in range(12))
"""How CDR begins: a zero, and one of the kinds of the DDS and XTypes standards."""


class StorageFile(Protocol):
    """One file of a bag; ``channels`` and ``counts`` by the file's own numbers of them."""

    channels: dict[int, Channel]
    counts: dict[int, int]
    spans: list[Span]
    notes: list[str]

    def messages(
        self, keys: Collection[int], first: int, last: int
    ) -> Iterator[tuple[int, int, bytes]]:
        """Yield (stamp, number, bytes) from ``first`` to ``last`` ns in order of time."""

    def close(self) -> None:
        """Let go of the file."""


@dataclass(frozen=True)
class _Part:
    file: StorageFile
    labels: dict[int, str]


class Bag:
    """An opened bag. ``topics``: by a label, which is the topic's name unless it has two types.

    ``spans``: stretches with messages, in ns; ``start`` and ``end``: of the first and last one.
    """

    def __init__(self, files: BagFiles) -> None:
        self._notes = list(files.notes)
        self._has_lost = bool(files.missing)
        self._bad: dict[tuple[str, str], set[int]] = {}
        self._scratch: TemporaryDirectory[str] | None = None
        self._parts: list[_Part] = []
        opened: list[StorageFile] = []
        for path in files.files:
            try:
                opened.append(self._open(path))
            except (BagError, OSError) as error:
                if len(files.files) == 1:
                    raise _named(path, error) from None
                self._notes.append(f"{path.name} is left out: {_reason(path, error)}")
                self._has_lost = True
        known = Topics(files.about.kept)
        keys = [known.take(file) for file in opened]
        self.topics, labels = known.labelled()
        self._parts = [
            _Part(file, {key: labels[topic] for key, topic in mine.items()})
            for file, mine in zip(opened, keys, strict=True)
        ]
        self.spans = joined(span for file in opened for span in file.spans)
        self.start = self.spans[0][0] if self.spans else 0
        self.end = self.spans[-1][1] if self.spans else 0
        self._check_count(files)

    @property
    def notes(self) -> list[str]:
        """What is left out or damaged, as far as it is known by now."""
        told = [note for part in self._parts for note in part.file.notes]
        bad = [
            f"{topic}: {len(at)} messages are left out: {why}"
            for (topic, why), at in self._bad.items()
        ]
        return self._notes + told + bad

    @property
    def bad_messages(self) -> int:
        """Messages that were asked for and are left out."""
        return sum(map(len, self._bad.values()))

    @property
    def is_damaged(self) -> bool:
        """Whether messages are lost, or may be."""
        return self._has_lost or any(part.file.notes for part in self._parts) or bool(self._bad)

    def messages(
        self, topics: Collection[str], start: int = EARLIEST, stop: int = LATEST
    ) -> Iterator[Message]:
        """Yield the messages of ``topics`` from ``start`` to before ``stop`` in order of time.

        What rosbag2 compressed is unpacked. A message that is none is left out and counted.
        """
        streams = [self._stream(part, topics, start, stop) for part in self._parts]
        if len(streams) == 1:
            yield from streams[0]
        else:
            yield from merge(*streams, key=lambda message: message[0])

    def close(self) -> None:
        """Let go of the files, and remove unpacked ones."""
        for part in self._parts:
            part.file.close()
        if self._scratch is not None:
            self._scratch.cleanup()

    def _stream(
        self, part: _Part, topics: Collection[str], start: int, stop: int
    ) -> Iterator[Message]:
        wanted = {key: label for key, label in part.labels.items() if label in topics}
        if not wanted:
            return
        for stamp, key, data in part.file.messages(
            wanted, max(start, EARLIEST), min(stop, LATEST) - 1
        ):
            if data[:2] in CDR_KINDS or self.topics[wanted[key]].encoding != "cdr":
                yield stamp, wanted[key], data
            elif (content := self._unpacked(stamp, wanted[key], data)) is not None:
                yield stamp, wanted[key], content

    def _unpacked(self, stamp: int, topic: str, data: bytes) -> bytes | None:
        """Return the content of what does not begin as CDR does; None where it is lost."""
        why = f"they are no CDR, they begin with {data[:4].hex() or 'nothing'}"
        if data.startswith(ZSTD):
            try:
                content = unpack_message(data)
                if content[:2] in CDR_KINDS:
                    return content
            except ValueError as error:
                why = f"they are compressed, and cannot be unpacked: {error}"
        self._bad.setdefault((topic, why), set()).add(stamp)
        return None

    def _open(self, path: Path) -> StorageFile:
        from steering_bringup.bags.sources.mcap_file import McapFile
        from steering_bringup.bags.sources.sqlite_file import SqliteFile

        kind = kind_of(path)
        if kind == "zstd":
            if self._scratch is None:
                self._scratch = TemporaryDirectory(prefix="steer-bag-")
            unpacked, damage = unpack_file(path, Path(self._scratch.name))
            if damage:
                self._notes.append(f"{path.name}: {damage}")
                self._has_lost = True
            return self._open(unpacked)
        if kind == "mcap":
            return McapFile(path)
        if kind == "sqlite" or (kind == "empty" and path.with_name(path.name + "-wal").exists()):
            return SqliteFile(path)
        if kind == "empty":
            raise BagError(f"'{path}' is empty, the recording broke off")
        if kind == "ros1" or path.suffix == ".bag":
            raise BagError(f"'{path}' is {OF_ROS1}")
        raise BagError(f"'{path}' cannot be read: it is no MCAP and no SQLite file")

    def _check_count(self, files: BagFiles) -> None:
        """Note that metadata.yaml counts other messages than there are, if nothing else tells."""
        counted = sum(info.count for info in self.topics.values())
        told = files.about.messages
        if told not in (None, counted) and not self.notes:
            self._notes.append(f"metadata.yaml counts {told} messages, there are {counted}")


def open_bag(path: Path) -> Bag:
    """Open a bag: a folder, or one MCAP or SQLite file, complete or cut off, compressed or not.

    One bad part never costs the rest: what is left out is in ``notes``.
    Raises BagError, naming the path, if there is nothing in it.
    """
    bag = Bag(bag_files(path))
    if not any(info.count for info in bag.topics.values()):
        reasons = f": {'; '.join(bag.notes)}" if bag.notes else ""
        bag.close()
        raise BagError(f"'{path}' holds no message{reasons}")
    return bag


def _named(path: Path, error: Exception) -> BagError:
    return error if isinstance(error, BagError) else BagError(f"'{path}' cannot be read: {error}")


def _reason(path: Path, error: Exception) -> str:
    return str(error).replace(f"'{path}' ", "", 1)
