"""The end of an MCAP file, from its metadata on, with the checksums that rosbags leaves out."""

from __future__ import annotations

import struct
import zlib

_DATA_END = struct.Struct("<BQI")
"""Operation, length, checksum of everything before it."""

_FOOTER = struct.Struct("<BQQQI")
"""Operation, length, start of the summary, of its offsets, checksum of the summary until here."""

_MAGIC_SIZE = 8


class FileEnd:
    """Takes what rosbags writes at the end of a file, in memory; ``start``: its place there."""

    def __init__(self, start: int) -> None:
        self._start = start
        self._bytes = bytearray()

    def write(self, data: bytes | bytearray | memoryview) -> int:
        """Add bytes."""
        self._bytes += data
        return len(data)

    def tell(self) -> int:
        """Position in the file."""
        return self._start + len(self._bytes)

    def close(self) -> None:
        """Do nothing; rosbags closes what it has written."""

    def with_checksums(self, before: int) -> bytearray:
        """Return the bytes with both checksums; ``before``: CRC-32 of the file until ``start``.

        The first is of the whole file before the record that ends its data, the second of the
        summary and the footer before it (MCAP specification, Data End and Footer).
        """
        end = self._bytes
        footer = len(end) - _MAGIC_SIZE - _FOOTER.size
        operation, length, summary, offsets, _ = _FOOTER.unpack_from(end, footer)
        first = summary - self._start
        data_end = first - _DATA_END.size
        kind, size, _ = _DATA_END.unpack_from(end, data_end)
        _DATA_END.pack_into(end, data_end, kind, size, zlib.crc32(end[:data_end], before))
        checked = zlib.crc32(end[first : footer + _FOOTER.size - 4])
        _FOOTER.pack_into(end, footer, operation, length, summary, offsets, checked)
        return end
