"""Message definitions that go into a bag, so that it can be read without this software."""

from __future__ import annotations

import os
from collections.abc import Mapping
from functools import cache, lru_cache
from pathlib import Path

from rosbags.typesys import Stores, TypesysError, get_types_from_msg, get_typestore
from rosbags.typesys.store import Typestore

from steering_bringup.bags.errors import BagError

PACKAGE = "steering_msgs"
UNKNOWN_HASH = "RIHS01_0"
_SECTION = "=" * 80 + "\n"


def message_folders() -> list[Path]:
    """Folders that may hold our .msg files: the built workspace first, then the source tree."""
    prefixes = [Path(p) for p in os.environ.get("AMENT_PREFIX_PATH", "").split(os.pathsep) if p]
    folders = [prefix / "share" / PACKAGE / "msg" for prefix in prefixes]
    here = Path(__file__).resolve()
    return folders + [parent / PACKAGE / "msg" for parent in here.parents]


@cache
def _message_texts() -> dict[str, str]:
    """Return message type -> the text of its .msg file, comments with units included."""
    for folder in message_folders():
        files = sorted(folder.glob("*.msg"))
        if files:
            return {f"{PACKAGE}/msg/{f.stem}": f.read_text(encoding="utf-8") for f in files}
    raise BagError(
        f"the definitions of {PACKAGE} were not found: build the workspace and source it "
        "(AMENT_PREFIX_PATH), or run from its source tree"
    )


@cache
def typestore() -> Typestore:
    """Every standard Jazzy type and our own."""
    store = get_typestore(Stores.ROS2_JAZZY)
    for name, text in _message_texts().items():
        store.register(get_types_from_msg(text, name))
    return store


@cache
def definition(msgtype: str) -> tuple[str, str]:
    """Return (full definition text, RIHS01 hash) of a message type.

    The first section of our own types is the original text: its comments carry unit and sign.
    Raises BagError for a type that is neither standard nor ours.
    """
    store = typestore() if msgtype.startswith(PACKAGE) else _standard_types()
    if msgtype not in store.fielddefs:
        raise BagError(f"message type '{msgtype}' is not known: it is neither ours nor standard")
    text, _ = store.generate_msgdef(msgtype, ros_version=2)
    if msgtype.startswith(PACKAGE):
        sections = text.split(_SECTION)
        sections[0] = _message_texts()[msgtype].rstrip("\n") + "\n"
        text = _SECTION.join(sections)
    return text, store.hash_rihs01(msgtype)


def definition_of(msgtype: str, given: Mapping[str, str] | None) -> tuple[str, str]:
    """`definition`, or that from `given` texts (another bag's) where they are."""
    if given is None:
        return definition(msgtype)
    store = typestore_of({msgtype: given[msgtype]})
    known = msgtype in store.fielddefs
    return given[msgtype], store.hash_rihs01(msgtype) if known else UNKNOWN_HASH


@cache
def _standard_types() -> Typestore:
    return get_typestore(Stores.ROS2_JAZZY)


def typestore_of(definitions: dict[str, str]) -> Typestore:
    """A type store from the definitions that a bag carries (type -> definition text).

    Definitions that cannot be parsed are left out.
    """
    return _typestore_of(tuple(sorted(definitions.items())))


@lru_cache(maxsize=16)
def _typestore_of(definitions: tuple[tuple[str, str], ...]) -> Typestore:
    store = get_typestore(Stores.EMPTY)
    for name, text in definitions:
        try:
            types = get_types_from_msg(text, name)
        except TypesysError:
            # Messages of a type that cannot be understood are kept as bytes.
            continue
        store.register({n: t for n, t in types.items() if n not in store.fielddefs})
    return store
