"""Low-level pass over an MCAP file, complete or cut off, that finds every message in it."""

from __future__ import annotations

import zlib
from collections.abc import Iterator

import numpy as np

from steering_bringup.bags import mcap_bytes as mcap
from steering_bringup.bags.chunks import Block, Chunk, Scan, define, open_chunk, salvage
from steering_bringup.bags.mcap_bytes import CUT_CHUNK, MAGIC, RECORD_HEAD, u16

__all__ = ["Block", "Scan", "scan"]


def scan(data: memoryview) -> Scan:
    """Find all messages in an MCAP file given as its bytes.

    Never raises on damage: what is whole is returned, the rest is told in `damage`.
    Raises ValueError if the file is no MCAP file at all.
    """
    head = data[: len(MAGIC)].tobytes()
    if not MAGIC.startswith(head):
        raise ValueError("no MCAP file: its first bytes are not MCAP's")
    found = Scan()
    loose: dict[int, list[int]] = {}
    pending: Chunk | None = None
    expected: int | None = None
    for op, start, body, end in _records(data, len(MAGIC), found):
        if op == mcap.MESSAGE_INDEX:
            if pending:
                pending.take_index(data[body:end])
            continue
        if pending:
            pending.finish(found)
            pending = None
        if op == mcap.CHUNK:
            pending = open_chunk(data, start, body, end, found)
        elif op == CUT_CHUNK:
            salvage(data[body:end], found)
        elif op == mcap.MESSAGE and end - body >= mcap.PAYLOAD - RECORD_HEAD:
            (number,) = u16(data, body)
            loose.setdefault(found.current.get(number, number), []).append(start)
        elif op == mcap.STATISTICS and end - body >= 8:
            (expected,) = mcap.u64(data, body)
        elif op == mcap.DATA_END and end - body >= 4 and not found.damage:
            _check_data(data[:start], mcap.u32(data, body)[0], found)
        else:
            define(op, data[body:end], found)
    if pending:
        pending.finish(found)
    if loose:
        found.blocks.append(Block(data, {c: np.array(o) for c, o in loose.items()}))
    if expected is not None and expected != found.message_count:
        found.damage.append(f"{expected} messages were recorded")
    ended = len(data) >= 2 * len(MAGIC) and data[-len(MAGIC) :].tobytes() == MAGIC
    found.finished = ended and not found.damage
    if not found.finished and not found.damage:
        found.damage.append("the file's end is missing")
    return found


def _check_data(data: memoryview, checksum: int, found: Scan) -> None:
    """Compare everything before the end of the data with its checksum, 0 where there is none."""
    if checksum and zlib.crc32(data) != checksum:
        found.damage.append("something beside its chunks is damaged: a checksum does not fit")


def _records(data: memoryview, position: int, found: Scan) -> Iterator[tuple[int, int, int, int]]:
    """Yield (op, start, body, end) of whole records, and of a chunk that is cut off at the end."""
    size = len(data)
    while position < size:
        if position + RECORD_HEAD > size:
            found.damage.append(f"cut off at byte {size}, in a record's head")
            return
        op, length = mcap.head(data, position)
        body = position + RECORD_HEAD
        end = body + length
        if end > size:
            found.damage.append(f"cut off at byte {size}, {end - size} bytes short of a record")
            if op == mcap.CHUNK:
                yield CUT_CHUNK, position, body, size
            return
        yield op, position, body, end
        if op == mcap.FOOTER:
            return
        position = end
