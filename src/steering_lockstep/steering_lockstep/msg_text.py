"""Reads ROS message definitions (.msg text) into a flat list of fields. Pure, no ROS import."""

from __future__ import annotations

import os
import re
import sys
from collections.abc import Iterator
from dataclasses import dataclass
from functools import cache
from pathlib import Path

SCALARS = {
    "bool": "?",
    "byte": "B",
    "char": "B",
    "int8": "b",
    "uint8": "B",
    "int16": "h",
    "uint16": "H",
    "int32": "i",
    "uint32": "I",
    "int64": "q",
    "uint64": "Q",
    "float32": "f",
    "float64": "d",
}
_FIELD = re.compile(r"^\s*([\w/]+)(\[[^\]]*\])?\s+(\w+)(?:\s+[^=\s].*)?\s*$")


class MessageError(ValueError):
    """A message definition is missing or is not of fixed size."""


@dataclass(frozen=True)
class Leaf:
    """A field of plain data: ``path`` "header.stamp.sec", ``code`` of ``struct`` or "s"."""

    path: str
    code: str
    count: int = 1


def leaves(type_name: str, prefix: str = "") -> Iterator[Leaf]:
    """Yield the plain fields of ``type_name`` ("package/Name") depth first, in wire order.

    Raises ``MessageError`` for sequences, whose size is not known beforehand.
    """
    package = type_name.split("/")[0]
    for kind, array, name in _fields(definition(type_name)):
        path = prefix + name
        count = _count(array, path)
        if kind in SCALARS:
            yield Leaf(path, SCALARS[kind], count)
        elif kind == "string" and not array:
            yield Leaf(path, "s")
        elif not array:
            yield from leaves(_full_name(kind, package), path + ".")
        else:
            raise MessageError(f"{type_name}: array of messages {path} is not supported")


def definition(type_name: str) -> str:
    """Return the .msg text of ``type_name`` ("package/Name"; "package/msg/Name" works too)."""
    package, name = type_name.split("/")[0], type_name.split("/")[-1]
    return _read(package, name)


@cache
def _read(package: str, name: str) -> str:
    for folder in _folders(package):
        path = folder / f"{name}.msg"
        if path.is_file():
            return path.read_text(encoding="utf-8")
    raise MessageError(f"no definition of message {package}/{name}; is the workspace built?")


def _folders(package: str) -> Iterator[Path]:
    """Folders that may hold a package's .msg files: source tree, then installed prefixes."""
    yield Path(__file__).resolve().parents[2] / package / "msg"
    for prefix in os.environ.get("AMENT_PREFIX_PATH", "").split(os.pathsep):
        if prefix:
            yield Path(prefix) / "share" / package / "msg"
    yield Path(sys.prefix) / "share" / package / "msg"


def _fields(text: str) -> Iterator[tuple[str, str | None, str]]:
    for line in text.splitlines():
        match = _FIELD.match(line.split("#")[0])
        if match:
            yield match.group(1), match.group(2), match.group(3)


def _count(array: str | None, path: str) -> int:
    if not array:
        return 1
    size = array.strip("[]")
    if not size.isdigit():
        raise MessageError(f"field {path} is a sequence; only fixed sizes have a fixed layout")
    return int(size)


def _full_name(kind: str, package: str) -> str:
    if "/" in kind:
        return kind
    return "std_msgs/Header" if kind == "Header" else f"{package}/{kind}"
