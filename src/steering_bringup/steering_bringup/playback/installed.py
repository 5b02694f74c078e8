"""Message types that are installed here: their Python classes, and whether a bag's is the same."""

from __future__ import annotations

import importlib
import json
from functools import cache
from pathlib import Path
from typing import Any

from steering_bringup.bags.definitions import parse_definition, typestore_of
from steering_bringup.bags.meaning import (
    Field,
    fields_of_definition,
    fields_of_description,
    first_difference,
)
from steering_bringup.bags.sources import TopicInfo

CDR = "cdr"
RIHS01_LENGTH = len("RIHS01_") + 64


class NotPlayable(Exception):  # noqa: N818  (it is told, not an error)
    """A topic cannot be published; the text says why."""


def message_class(info: TopicInfo) -> Any:
    """Return the generated class of a topic's messages.

    Raises NotPlayable where the type is not installed or is another than the bag's.
    """
    if info.encoding != CDR:
        raise NotPlayable(f"its messages are encoded as '{info.encoding}', not as {CDR}")
    if not info.msgtype:
        raise NotPlayable("the bag does not tell its type, it has no schema")
    try:
        made = _imported(info.msgtype)
    except (ImportError, AttributeError, ValueError, TypeError):
        raise NotPlayable(f"its type {info.msgtype} is not installed") from None
    difference = _difference(info)
    if difference:
        raise NotPlayable(f"the bag's {info.msgtype} has other fields: {difference}")
    return made


def _imported(msgtype: str) -> Any:
    """Import the class of a message, or of a part of a service or an action."""
    package, folder, name = msgtype.split("/")
    module = importlib.import_module(f"{package}.{folder}")
    if folder == "msg":
        return getattr(module, name)
    whole, _, part = name.rpartition("_")
    made = getattr(module, whole)
    return getattr(made, part, None) or getattr(made.Impl, part)


def _difference(info: TopicInfo) -> str:
    """Return where the bag's type is another than the installed one; empty: nowhere.

    The fields are compared, and the hashes where the bag has no definition that we can read.
    """
    installed = _installed(info.msgtype)
    if installed is None:
        return ""
    fields, digest = installed
    try:
        types = parse_definition(info.msgtype, info.definition)
        if types:
            store = typestore_of({info.msgtype: info.definition})
            theirs = fields_of_definition(info.msgtype, store.fielddefs)
            return first_difference(theirs, fields)
    except KeyError:
        pass  # a part of it is not known
    known = info.digest.startswith("RIHS01_") and len(info.digest) == RIHS01_LENGTH
    return "its type's hash is another" if known and info.digest != digest else ""


@cache
def _installed(msgtype: str) -> tuple[tuple[Field, ...], str] | None:
    """Return fields and RIHS01 hash of an installed type; None where its package does not tell."""
    from ament_index_python.packages import get_package_share_directory

    package, folder, name = msgtype.split("/")
    try:
        file = Path(get_package_share_directory(package), folder, f"{name}.json")
        content = json.loads(file.read_text(encoding="utf-8"))
        hashes = {entry["type_name"]: entry["hash_string"] for entry in content["type_hashes"]}
        return fields_of_description(content["type_description_msg"]), hashes.get(msgtype, "")
    except (LookupError, OSError, ValueError, TypeError):
        return None
