"""From the bytes of a file to its text, and files that hold no text named as what they are."""

from __future__ import annotations

import gzip
import re
import zlib
from collections.abc import Iterator
from pathlib import Path

from steering_core.errors import BenchError

MARKS = {
    b"\xef\xbb\xbf": "utf-8",
    b"\xff\xfe\x00\x00": "utf-32-le",
    b"\x00\x00\xfe\xff": "utf-32-be",
    b"\xff\xfe": "utf-16-le",
    b"\xfe\xff": "utf-16-be",
}
"""Byte order marks. The longer one of UTF-32 stands before the one that it begins with."""

OTHERS = {
    b"PK\x03\x04": "an Excel workbook (or another archive): save the sheet as CSV",
    b"\xd0\xcf\x11\xe0": "an Excel workbook: save the sheet as CSV",
    b"MDF ": "an MDF file: give it the ending '.mf4'",
    b"MATLAB 5": "a MATLAB file: give it the ending '.mat'",
    b"MATLAB 7": "a MATLAB file: give it the ending '.mat'",
    b"\x89HDF": "an HDF5 file: if MATLAB wrote it, give it the ending '.mat'",
    b"TDSm": "a LabVIEW TDMS file: export it as CSV",
    b"SQLite format": "a database (SQLite)",
    b"\x89MCAP": "a bag (MCAP): give it the ending '.mcap'",
    b"%PDF": "a PDF document",
    b"{\\rtf": "a text document (RTF)",
    b"<?xml": "an XML document: save the sheet as CSV",
    b"<!DOCTYPE": "a web page (HTML): save the table as CSV",
    b"<html": "a web page (HTML): save the table as CSV",
}
"""How files begin that people rename to CSV, and what they are."""

FALLBACKS = ("cp850", "mac-roman", "utf-8")
"""Tried last: the DOS and Macintosh flavours of Excel's CSV, UTF-8 with broken bytes."""

HEAD = 1 << 16
"""Bytes or characters by which a file is judged."""

ZEROS = 0.3
"""Share of zero bytes at every second place that only UTF-16 has."""

CONTROL = re.compile("[\x01-\x08\x0b\x0e-\x19\x1b-\x1f\x7f]")
MOST_CONTROL = 0.002
"""Share of control characters that no table has."""


def read_texts(path: Path, encoding: str | None) -> Iterator[tuple[str, str]]:
    """Yield encoding and text, line ends ``\\n``, by each encoding, the most probable first.

    One only where ``encoding`` or the bytes themselves decide. BenchError: no text, or bytes that
    the given encoding does not have.
    """
    data = _bytes(path)
    if not data.strip(b"\x00\r\n\t "):
        raise BenchError(f"'{path}' is empty" + (" but for zero bytes" if b"\x00" in data else ""))
    for begin, kind in OTHERS.items():
        if data.startswith(begin):
            raise BenchError(f"'{path}' is no CSV file but {kind}")
    any_text = False
    for name in [encoding] if encoding else _encodings(data):
        text = _decoded(data, name, path, strict=encoding is not None)
        if not _is_text(text):
            continue
        any_text = True
        yield name, text
    if not any_text:
        hint = f" in the encoding {encoding}" if encoding else ""
        raise BenchError(f"'{path}' holds no text{hint}: it is no CSV file")


def _bytes(path: Path) -> bytes:
    try:
        data = path.read_bytes()
        return gzip.decompress(data) if data.startswith(b"\x1f\x8b") else data
    except (OSError, EOFError, zlib.error) as error:
        raise BenchError(f"'{path}' cannot be read: {error}") from None


def _encodings(data: bytes) -> Iterator[str]:
    """Yield encodings by the rule: byte order mark, valid UTF-8, UTF-16 by its zeros, cp1252.

    Only behind cp1252 is anything left to choose; there chardet is asked.
    """
    for mark, name in MARKS.items():
        if data.startswith(mark):
            yield name
            return
    if (wide := _utf_16(data)) is not None:
        yield wide
        return
    try:
        data.decode("utf-8")
    except UnicodeDecodeError as error:
        if error.end < len(data) or error.reason != "unexpected end of data":
            yield "cp1252"
            yield from _guesses(data)
            return
    yield "utf-8"


def _utf_16(data: bytes) -> str | None:
    head = data[:HEAD]
    even, odd = (head[k::2].count(0) / max(len(head) // 2, 1) for k in (0, 1))
    if odd > ZEROS and even < 0.1 * odd:
        return "utf-16-le"
    return "utf-16-be" if even > ZEROS and odd < 0.1 * even else None


def _guesses(data: bytes) -> Iterator[str]:
    import chardet

    lines = [line for line in data.split(b"\n") if not line.isascii()]
    found = chardet.detect_all(b"\n".join(lines)[:HEAD], compat_names=False)
    guessed = [str(each["encoding"]) for each in found if each["encoding"]]
    yield from dict.fromkeys((*guessed, *FALLBACKS))


def _decoded(data: bytes, name: str, path: Path, strict: bool) -> str:
    """Return the text; with ``strict``, bytes that the encoding does not have are an error."""
    try:
        text = data.decode(name, errors="strict" if strict else "replace")
    except UnicodeDecodeError as error:
        line = data.count(b"\n", 0, error.start) + 1
        raise BenchError(
            f"'{path}', line {line}: no {name} ({error.reason}): see `encoding` in the mapping"
        ) from None
    text = text.removeprefix("\ufeff").rstrip("\x00\x1a")
    return text.replace("\r\n", "\n").replace("\r", "\n").replace("\x00", "\ufffd")


def _is_text(text: str) -> bool:
    head = text[:HEAD]
    return len(CONTROL.findall(head)) <= MOST_CONTROL * len(head)
