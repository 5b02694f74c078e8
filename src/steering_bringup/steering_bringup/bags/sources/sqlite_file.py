"""An SQLite file of rosbag2, of any of its versions, complete or cut off."""

from __future__ import annotations

import shutil
import sqlite3
from collections.abc import Collection, Iterator
from itertools import islice
from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np

from steering_bringup.bags.chunks import Channel
from steering_bringup.bags.errors import BagError
from steering_bringup.bags.sources.spans import SILENCE_NS, Span, joined, spans_of
from steering_bringup.bags.sources.sqlite_salvage import DAMAGE, Row, padded, salvaged

SOUND = "typeof(timestamp) = 'integer' AND typeof(data) = 'blob'"
EXTENT = (
    "SELECT topic_id, count(*), min(timestamp), max(timestamp) FROM messages "
    f"WHERE {SOUND} GROUP BY topic_id"
)
ALL = "SELECT count(*) FROM messages"
STAMPS = "SELECT timestamp FROM messages WHERE typeof(timestamp) = 'integer' ORDER BY timestamp"
BETWEEN = (
    "SELECT timestamp, topic_id, data FROM messages "
    f"WHERE timestamp >= ? AND timestamp <= ? AND {SOUND}"
)
ORDER = "ORDER BY timestamp, id"


class SqliteFile:
    """Streams from the file. What a sound database gives through its index, a damaged one gives row
    by row, and that is held in memory.
    """

    def __init__(self, path: Path) -> None:
        self.path = path
        self.notes: list[str] = []
        self.channels: dict[int, Channel] = {}
        self._rows: list[Row] | None = None
        self._copy: TemporaryDirectory[str] | None = None
        try:
            self._connection = self._connect(path)
        except (*DAMAGE, OSError) as error:
            raise BagError(f"'{path}' cannot be read: {error}") from error
        self._connection.text_factory = _text
        try:
            self._open()
        except DAMAGE as error:
            self.close()
            raise BagError(f"'{path}' cannot be read: {error}") from error

    def messages(
        self, keys: Collection[int], first: int, last: int
    ) -> Iterator[tuple[int, int, bytes]]:
        """Yield (stamp, topic's number, bytes) of topics ``keys`` in order of time."""
        given = 0
        if self._rows is None:
            places = ", ".join(str(key) for key in keys)
            query = f"{BETWEEN} AND topic_id IN ({places}) {ORDER}"
            try:
                for row in self._connection.execute(query, (first, last)):
                    yield row
                    given += 1
                return
            except DAMAGE as error:
                self._salvage(error)
        rows = (r for r in self._rows or () if r[1] in keys and first <= r[0] <= last)
        yield from islice(rows, given, None)

    def close(self) -> None:
        """Close the file."""
        self._connection.close()
        if self._copy is not None:
            self._copy.cleanup()

    def _open(self) -> None:
        try:
            self.channels = _channels(self._connection)
            rows = self._all(EXTENT)
            self._count(rows)
        except DAMAGE as error:
            self._salvage(error)

    def _count(self, rows: list[tuple[int, int, int, int]]) -> None:
        self.counts = {key: count for key, count, _, _ in rows if key in self.channels}
        ((every,),) = self._all(ALL)
        if lost := every - sum(self.counts.values()):
            self.notes.append(
                f"{self.path.name}: {lost} rows without a time, content or known topic are left out"
            )
        ends = [(low, high) for key, _, low, high in rows if key in self.channels]
        self.spans: list[Span] = joined(ends)
        if self.spans and self.spans[-1][1] - self.spans[0][0] > SILENCE_NS:
            self.spans = spans_of(np.array([stamp for (stamp,) in self._all(STAMPS)], np.int64))

    def _salvage(self, error: Exception) -> None:
        """Take what is left of the file into memory."""
        self._connection.close()
        self._connection, is_short = padded(self.path)
        self._connection.text_factory = _text
        self.channels = self.channels or _channels(self._connection)
        found = [row for row in salvaged(self._connection, is_short) if row[1] in self.channels]
        self._rows = sorted(found, key=lambda row: row[0])
        self.counts = dict.fromkeys(self.channels, 0)
        for _, key, _ in self._rows:
            self.counts[key] += 1
        self.spans = spans_of(np.array([stamp for stamp, _, _ in self._rows], np.int64))
        self.notes.append(
            f"{self.path.name} is damaged ({error}): the {len(self._rows)} messages that can be "
            "read are there"
        )

    def _connect(self, path: Path) -> sqlite3.Connection:
        """Open for reading only; a log that a crash left is taken in."""
        connection = sqlite3.connect(f"{path.absolute().as_uri()}?mode=ro", uri=True)
        try:
            connection.execute("SELECT count(*) FROM sqlite_master").fetchone()
            return connection
        except sqlite3.OperationalError:
            connection.close()
        except DAMAGE:
            return connection  # told by the first who reads
        logs = [path.with_name(path.name + end) for end in ("-wal", "-journal")]
        if logs := [log for log in logs if log.is_file() and log.stat().st_size]:
            return sqlite3.connect(self._copied(path, logs))
        return sqlite3.connect(f"{path.absolute().as_uri()}?immutable=1", uri=True)

    def _copied(self, path: Path, logs: list[Path]) -> Path:
        """Copy a file whose logs cannot be taken in where it is; return the copy."""
        self._copy = TemporaryDirectory(prefix="steer-bag-")
        for file in (path, *logs):
            shutil.copyfile(file, Path(self._copy.name, file.name))
        return Path(self._copy.name, path.name)

    def _all(self, query: str) -> list[tuple]:
        return self._connection.execute(query).fetchall()


def _channels(connection: sqlite3.Connection) -> dict[int, Channel]:
    """Return the topics by number. Columns and tables differ between the versions of rosbag2."""
    have = {row[1] for row in connection.execute("PRAGMA table_info(topics)")}
    if not {"id", "name", "type"} <= have:
        raise sqlite3.DatabaseError("it has no table of topics")
    more = ("serialization_format", "offered_qos_profiles", "type_description_hash")
    columns = ", ".join(name if name in have else "NULL" for name in more)
    texts = _definitions(connection)
    made = {}
    for row in connection.execute(f"SELECT id, name, type, {columns} FROM topics"):
        name, kind, encoding, qos, digest = map(_text, row[1:])
        encoding = encoding or "cdr"  # the only one that the first version had
        made[int(row[0])] = Channel(name, kind, texts.get(kind, ""), encoding, qos, digest)
    return made


def _definitions(connection: sqlite3.Connection) -> dict[str, str]:
    have = {row[1] for row in connection.execute("PRAGMA table_info(message_definitions)")}
    if not {"topic_type", "encoded_message_definition"} <= have:
        return {}
    query = "SELECT topic_type, encoded_message_definition FROM message_definitions"
    return {_text(kind): _text(text) for kind, text in connection.execute(query)}


def _text(value: object) -> str:
    if isinstance(value, bytes):
        return value.decode("utf-8", "replace")
    return "" if value is None else str(value)
