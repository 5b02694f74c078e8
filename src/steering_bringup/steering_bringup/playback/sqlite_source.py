"""SQLite files of rosbag2, complete or cut off."""

from __future__ import annotations

import sqlite3
from collections.abc import Collection, Iterator, Sequence
from heapq import merge
from pathlib import Path

from steering_bringup.bags.errors import BagError
from steering_bringup.playback.source import Message, TopicInfo

MAGIC = b"SQLite format 3\0"
MISSING = b"\xff"
LEAST_PAGE = 512
TOPICS = "SELECT id, name, type, serialization_format FROM topics"
EXTENT = "SELECT topic_id, count(*), min(timestamp), max(timestamp) FROM messages GROUP BY topic_id"
BETWEEN = "SELECT timestamp, topic_id, data FROM messages WHERE timestamp >= ? AND timestamp < ?"


class SqliteSource:
    """Streams from the files; only what a damaged one still gives is held in memory."""

    def __init__(self, files: Sequence[Path], durable: Collection[str] = ()) -> None:
        self.topics: dict[str, TopicInfo] = {}
        self.notes: list[str] = []
        self._files: list[_File] = []
        for path in files:
            try:
                file = _File(path, self.notes)
            except sqlite3.DatabaseError as error:
                raise BagError(f"'{path}' cannot be read: {error}") from error
            self._files.append(file)
            for name, msgtype, encoding, count in file.topics():
                known = self.topics.get(name)
                count += known.count if known else 0
                self.topics[name] = TopicInfo(msgtype, count, encoding, "", name in durable)
        ends = [file.extent for file in self._files if file.extent]
        self.start = min((start for start, _ in ends), default=0)
        self.end = max((end for _, end in ends), default=0)

    def messages(self, topics: Collection[str], start: int, stop: int) -> Iterator[Message]:
        """Yield the messages of ``topics`` from ``start`` to before ``stop`` in order of time."""
        streams = [file.messages(topics, start, stop) for file in self._files]
        return merge(*streams, key=lambda message: message[0])

    def close(self) -> None:
        """Close the files."""
        for file in self._files:
            file.close()


class _File:
    """One file. What a sound database gives through its index, a damaged one gives row by row."""

    def __init__(self, path: Path, notes: list[str]) -> None:
        self.salvaged: list[Message] | None = None
        self.connection = _connect(path)
        try:
            self._read_topics()
            rows = self._all(EXTENT)
        except sqlite3.DatabaseError as error:
            self.connection.close()
            self.connection = _padded(path)
            self._read_topics()
            self.salvaged = sorted(self._salvage(), key=lambda message: message[0])
            notes.append(
                f"{path.name} is damaged ({error}): its first {len(self.salvaged)} messages are "
                "played"
            )
            rows = []
        self.counts = {self.names[key][0]: count for key, count, _, _ in rows if key in self.names}
        times = [time for _, _, low, high in rows for time in (low, high)]
        for stamp, name, _ in self.salvaged or ():
            self.counts[name] = self.counts.get(name, 0) + 1
            times.append(stamp)
        self.extent = (min(times), max(times)) if times else None

    def close(self) -> None:
        """Close the file."""
        self.connection.close()

    def topics(self) -> Iterator[tuple[str, str, str, int]]:
        """Yield name, type, serialisation and number of messages."""
        for name, msgtype, encoding in self.names.values():
            yield name, msgtype, encoding, self.counts.get(name, 0)

    def messages(self, topics: Collection[str], start: int, stop: int) -> Iterator[Message]:
        """Yield messages in order of time."""
        if self.salvaged is not None:
            yield from (m for m in self.salvaged if m[1] in topics and start <= m[0] < stop)
            return
        wanted = {key: name for key, (name, _, _) in self.names.items() if name in topics}
        places = ", ".join(str(int(key)) for key in wanted)
        query = f"{BETWEEN} AND topic_id IN ({places}) ORDER BY timestamp, id"
        for stamp, key, data in self.connection.execute(query, (start, stop)):
            yield stamp, wanted[key], bytes(data)

    def _read_topics(self) -> None:
        self.names = {key: (name, kind, form) for key, name, kind, form in self._all(TOPICS)}

    def _salvage(self) -> Iterator[Message]:
        rows = self.connection.execute("SELECT timestamp, topic_id, data FROM messages NOT INDEXED")
        while True:
            try:
                row = next(rows, None)
            except sqlite3.DatabaseError:
                return
            if row is None:
                return
            # Content on a page of its own is not checked by SQLite: such a page may be missing.
            lost = len(row[2]) > LEAST_PAGE - 40 and bytes(row[2]).endswith(MISSING)
            if row[1] in self.names and not lost:
                yield row[0], self.names[row[1]][0], bytes(row[2])

    def _all(self, query: str) -> list[tuple]:
        return self.connection.execute(query).fetchall()


def _padded(path: Path) -> sqlite3.Connection:
    """Open what is left of a file, in memory, as if it had its full length.

    SQLite refuses a file that is shorter than its head says. With impossible pages in the place of
    the missing ones it reads up to them.
    """
    data = bytearray(path.read_bytes())
    if len(data) < 100 or not data.startswith(MAGIC):
        raise sqlite3.DatabaseError("it is no database")
    page = int.from_bytes(data[16:18], "big")
    page = 65536 if page == 1 else page
    size = page * int.from_bytes(data[28:32], "big")
    data[18:20] = b"\1\1"  # a write-ahead log has no place in memory
    connection = sqlite3.connect(":memory:")
    whole = bytes(data[: len(data) // page * page])
    connection.deserialize(whole.ljust(size, MISSING))
    return connection


def _connect(path: Path) -> sqlite3.Connection:
    """Open for reading only; a log that a crash left is taken in where the folder allows it."""
    place = path.absolute().as_uri()
    connection = sqlite3.connect(f"{place}?mode=ro", uri=True)
    try:
        connection.execute("SELECT count(*) FROM sqlite_master").fetchone()
    except sqlite3.OperationalError:
        connection.close()
        return sqlite3.connect(f"{place}?immutable=1", uri=True)
    except sqlite3.DatabaseError:
        pass  # told by the first who reads
    return connection
