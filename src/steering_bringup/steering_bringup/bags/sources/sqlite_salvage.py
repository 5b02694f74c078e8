"""What a damaged SQLite file still holds, row by row, around the pages that are lost."""

from __future__ import annotations

import sqlite3
from collections.abc import Iterator
from pathlib import Path

Row = tuple[int, int, bytes]
"""Time in ns, the topic's number, content."""

MAGIC = b"SQLite format 3\0"
MISSING = b"\xff"
LEAST_PAGE = 512
DAMAGE = (sqlite3.DatabaseError, UnicodeDecodeError)
"""What reading a damaged file raises; its own message may be no text."""

HIGHEST = (1 << 63) - 1
AFTER = "SELECT id, timestamp, topic_id, data FROM messages NOT INDEXED WHERE id > ? ORDER BY id"


def salvaged(connection: sqlite3.Connection, is_short: bool) -> Iterator[Row]:
    """Yield the rows that can be read, in the order in which they were written.

    ``is_short``: the end of the file is missing. Content on a page of its own is not checked by
    SQLite; it is then left out where such a page may be missing.
    """
    last: int | None = 0
    (pages,) = connection.execute("PRAGMA page_count").fetchone()
    for _ in range(pages):  # each of them can be bad once
        if last is None:
            return
        try:
            for number, stamp, key, data in connection.execute(AFTER, (last,)):
                if number <= last:
                    continue  # a damaged tree leads to a row again
                last = number
                sound = isinstance(stamp, int) and isinstance(key, int) and isinstance(data, bytes)
                lost = is_short and sound and len(data) > LEAST_PAGE - 40
                if sound and not (lost and data.endswith(MISSING)):
                    yield stamp, key, data
            return
        except DAMAGE:
            last = _behind(connection, last)


def _behind(connection: sqlite3.Connection, last: int) -> int | None:
    """Return the number behind which rows can be read again; None: nowhere."""
    step = 1
    while not _readable(connection, last + step):
        step *= 2
        if last + step > HIGHEST:
            return None
    bad, good = last + step // 2, last + step
    while good - bad > 1:
        middle = (bad + good) // 2
        if _readable(connection, middle):
            good = middle
        else:
            bad = middle
    return good


def _readable(connection: sqlite3.Connection, number: int) -> bool:
    try:
        connection.execute(f"{AFTER} LIMIT 1", (number,)).fetchone()
        return True
    except DAMAGE:
        return False


def padded(path: Path) -> tuple[sqlite3.Connection, bool]:
    """Return what is left of a file, in memory, as if it had its full length; whether it is short.

    SQLite refuses a file that is shorter than its head says. With impossible pages in the place of
    the missing ones it reads up to them. DatabaseError where it is no SQLite file.
    """
    data = bytearray(path.read_bytes())
    if len(data) < 100 or not data.startswith(MAGIC):
        raise sqlite3.DatabaseError("it is no database")
    page = int.from_bytes(data[16:18], "big")
    page = 65536 if page == 1 else page
    if page < LEAST_PAGE or page & (page - 1):
        raise sqlite3.DatabaseError("its head is damaged")
    size = page * int.from_bytes(data[28:32], "big")
    data[18:20] = b"\1\1"  # a write-ahead log has no place in memory
    connection = sqlite3.connect(":memory:")
    whole = bytes(data[: len(data) // page * page])
    try:
        connection.deserialize(whole.ljust(size, MISSING))
    except (MemoryError, OverflowError):
        raise sqlite3.DatabaseError("it is too large to be repaired in memory") from None
    return connection, size > len(whole)
