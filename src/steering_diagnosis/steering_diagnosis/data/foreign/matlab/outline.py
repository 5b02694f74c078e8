"""What a MAT file must hold, by its length and its outline, before anything is read of it."""

from __future__ import annotations

import struct
from collections.abc import Iterator
from pathlib import Path
from typing import BinaryIO, Literal

from steering_core.errors import BenchError

Kind = Literal["4", "5", "7.3", "HDF5"]

HDF5_SIGNATURE = b"\x89HDF\r\n\x1a\n"
PLACES_OF_HDF5 = (0, 512, 1024, 2048)
"""Bytes that may stand before an HDF5 file (its specification, II.A); 512 in MATLAB's."""

HEADER = 128
"""Bytes of text, version and byte order before the first variable of version 5 to 7.3."""

HEADER_4 = 20
"""Bytes of a version 4 variable's header: type, rows, columns, imaginary, length of the name."""

BYTES_4 = (8, 4, 4, 2, 2, 1)
"""Bytes of a number by the third digit of a version 4 type."""

MOST_DEFLATED = 1032
"""Bytes that one byte of deflate can stand for at most (RFC 1951: 258 bytes for two bits)."""

UNSUSPICIOUS = 1 << 28
"""Bytes of a data set below which its size is not compared with what the file holds of it."""


def check(path: Path) -> Kind:
    """Return the version of a MAT file; BenchError says in what it is none, or where it ends."""
    size = path.stat().st_size
    with path.open("rb") as file:
        head = file.read(PLACES_OF_HDF5[-1] + len(HDF5_SIGNATURE))
        if not head:
            raise _broken(path, "it is empty")
        is_hdf5 = any(head.startswith(HDF5_SIGNATURE, place) for place in PLACES_OF_HDF5)
        order = {b"IM": "<", b"MI": ">"}.get(head[126:128])
        if order is None and is_hdf5:
            return "HDF5"
        if order is None:
            _check_version_4(path, file, head, size)
            return "4"
        if head[125 if order == "<" else 124] == 2:
            if not is_hdf5:
                raise _broken(path, "it says it is version 7.3, but holds no HDF5 file")
            return "7.3"
        _check_version_5(path, file, order, size)
    return "5"


def check_hdf5(path: Path) -> None:
    """Refuse an HDF5 file that is cut off, or whose data sets claim what it cannot hold."""
    import h5py

    def look(name: str, item: object) -> None:
        if isinstance(item, h5py.Dataset) and item.nbytes > UNSUSPICIOUS:
            most = item.id.get_storage_size() * (MOST_DEFLATED if item.compression else 1)
            if item.nbytes > most:
                claims.append(f"'{name}' claims {item.nbytes:,} bytes, more than the file holds")

    claims: list[str] = []
    try:
        with h5py.File(path, "r") as file:
            file.visititems(look)
    except Exception as error:
        why = str(error).strip("'")
        cut = "truncated file" in why
        raise _broken(path, "it is cut off" if cut else f"it is damaged: {why}") from None
    if claims:
        raise _broken(path, claims[0])


def _check_version_4(path: Path, file: BinaryIO, head: bytes, size: int) -> None:
    order = next((order for order in "<>" if 0 <= _type_4(head, order) < 5000), "")
    if size < HEADER_4 or not order or (b"\x00" not in head[:4]):
        raise _broken(path, _instead(head))
    position = 0
    while position < size:
        file.seek(position)
        header = file.read(HEADER_4)
        if len(header) < HEADER_4:
            raise _broken(path, f"it is cut off at its end, in byte {position}")
        kind, rows, columns, imaginary, named = struct.unpack(order + "5i", header)
        digits = (kind // 1000, kind // 100 % 10, kind // 10 % 10, kind % 10)
        known = digits[1] == 0 and digits[2] < 6 and digits[3] < 3
        if not (0 <= kind < 5000 and known and min(rows, columns) >= 0 and 0 < named <= size):
            what = _instead(head) if position == 0 else f"byte {position} begins no variable"
            raise _broken(path, what)
        name = file.read(named).rstrip(b"\x00").decode("latin-1")
        if digits[0] > 1:
            raise _broken(path, f"'{name}' has the numbers of a VAX or a Cray")
        numbers = rows * columns * (2 if imaginary and digits[3] != 2 else 1)
        position += HEADER_4 + named + numbers * BYTES_4[digits[2]]
        if position > size:
            raise _broken(path, f"it is cut off in '{name}': {position - size} bytes are missing")


def _type_4(head: bytes, order: str) -> int:
    return int(struct.unpack(order + "i", head[:4].ljust(4, b"\xff"))[0])


def _check_version_5(path: Path, file: BinaryIO, order: str, size: int) -> None:
    for number, end in enumerate(_ends_5(path, file, order, size), start=1):
        if end > size:
            raise _broken(
                path, f"it is cut off in variable {number}: {end - size} bytes are missing"
            )


def _ends_5(path: Path, file: BinaryIO, order: str, size: int) -> Iterator[int]:
    """Yield where each variable ends; BenchError where none begins."""
    position = HEADER
    while position < size:
        file.seek(position)
        tag = file.read(8)
        if len(tag) < 8:
            raise _broken(path, f"it is cut off at its end, in byte {position}")
        kind, length = struct.unpack(order + "2I", tag)
        if kind not in (14, 15) or not length:
            raise _broken(path, f"byte {position} begins no variable: it is damaged there")
        position += 8 + length
        yield position
    if position == HEADER:
        raise _broken(path, "there is no variable in it")


def _instead(head: bytes) -> str:
    """Return what a file is that is no MAT file."""
    if head.startswith(b"MATLAB 5.0 MAT-file"):
        return "it is cut off in its header"
    if head[:2] in (b"PK", b"\x1f\x8b"):
        return "it is a zip archive: unpack it first"
    if head.startswith(b"version https://git-lfs"):
        return "it is a pointer of git LFS, not the file itself"
    text = all(byte >= 32 or byte in b"\t\r\n" for byte in head)
    return "it is a text file" if text else "it does not begin as one"


def _broken(path: Path, what: str) -> BenchError:
    return BenchError(f"'{path}' cannot be read as a MAT file: {what}")
