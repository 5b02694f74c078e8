"""A file that only grows by whole pieces: a write that fails leaves none of its bytes."""

from __future__ import annotations

import fcntl
import os
import zlib
from contextlib import suppress
from pathlib import Path


class AppendFile:
    """Collects bytes and puts them at the end of a file in one go on `flush`.

    A full disk may take a part of a write. `flush` then cuts the file back to where it was, so
    that what had been flushed before stays a whole number of records, and raises OSError.
    The file is locked while it is open: a reader can tell a running recording from a dead one.
    """

    def __init__(self, path: Path) -> None:
        self._descriptor = os.open(path, os.O_WRONLY | os.O_APPEND)
        # Some network file systems have no locks; the recording does not depend on one.
        with suppress(OSError):
            fcntl.flock(self._descriptor, fcntl.LOCK_EX | fcntl.LOCK_NB)
        self._flushed = os.fstat(self._descriptor).st_size
        self._pending = bytearray()
        self.checksum = zlib.crc32(path.read_bytes())
        """CRC-32 of everything flushed so far."""

    def write(self, data: bytes | bytearray | memoryview) -> int:
        """Add bytes to the next flush."""
        self._pending += data
        return len(data)

    def tell(self) -> int:
        """Position after everything written so far, flushed or not."""
        return self._flushed + len(self._pending)

    def flush(self) -> None:
        """Hand everything to the operating system, or nothing (OSError)."""
        pending, self._pending = self._pending, bytearray()
        view = memoryview(pending)
        try:
            while view:
                view = view[os.write(self._descriptor, view) :]
        except OSError:
            os.ftruncate(self._descriptor, self._flushed)
            raise
        self._flushed += len(pending)
        self.checksum = zlib.crc32(pending, self.checksum)

    def close(self) -> None:
        """Flush and close; the file is closed even if the flush fails."""
        if self._descriptor < 0:
            return
        try:
            self.flush()
        finally:
            os.close(self._descriptor)
            self._descriptor = -1


def is_being_written(path: Path) -> bool:
    """Whether a living process on this machine holds the lock of an AppendFile on `path`."""
    try:
        descriptor = os.open(path, os.O_RDONLY)
    except OSError:
        return False
    try:
        fcntl.flock(descriptor, fcntl.LOCK_SH | fcntl.LOCK_NB)
    except BlockingIOError:
        return True
    except OSError:
        return False
    finally:
        os.close(descriptor)
    return False
