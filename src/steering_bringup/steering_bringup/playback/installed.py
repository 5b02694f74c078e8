"""Message types that are installed here: their Python classes, and whether a bag's is the same."""

from __future__ import annotations

import importlib
import json
from functools import cache
from pathlib import Path
from typing import Any

from steering_bringup.bags.definitions import UNKNOWN_HASH, definition_of
from steering_bringup.playback.source import TopicInfo

CDR = "cdr"


class NotPlayable(Exception):  # noqa: N818  (it is told, not an error)
    """A topic cannot be published; the text says why."""


def message_class(info: TopicInfo) -> Any:
    """Return the generated class of a topic's messages.

    Raises NotPlayable where the type is not installed or is another than the bag's.
    """
    if info.encoding != CDR:
        raise NotPlayable(f"its messages are encoded as '{info.encoding}', not as {CDR}")
    package, _, name = info.msgtype.partition("/msg/")
    try:
        made = getattr(importlib.import_module(f"{package}.msg"), name)
    except (ImportError, AttributeError, ValueError):
        raise NotPlayable(f"its type {info.msgtype or '?'} is not installed") from None
    ours, theirs = installed_hash(info.msgtype), recorded_hash(info)
    if ours and theirs and ours != theirs:
        raise NotPlayable(f"the bag's {info.msgtype} has other fields than the installed one")
    return made


@cache
def installed_hash(msgtype: str) -> str | None:
    """Return the RIHS01 hash of an installed type; None where its package does not tell."""
    from ament_index_python.packages import get_package_share_directory

    package, _, name = msgtype.partition("/msg/")
    try:
        file = Path(get_package_share_directory(package), "msg", f"{name}.json")
        hashes = json.loads(file.read_text(encoding="utf-8"))["type_hashes"]
        return next(entry["hash_string"] for entry in hashes if entry["type_name"] == msgtype)
    except (LookupError, OSError, ValueError, TypeError, StopIteration):
        return None


def recorded_hash(info: TopicInfo) -> str | None:
    """Return the RIHS01 hash of the definition in the bag; None where it has none we can read."""
    if not info.definition:
        return None
    _, digest = definition_of(info.msgtype, {info.msgtype: info.definition})
    return None if digest == UNKNOWN_HASH else digest
