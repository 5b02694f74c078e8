"""Message definitions that go into a bag, so that it can be read without this software."""

from __future__ import annotations

import os
import re
from collections.abc import Iterable, Iterator, Mapping
from functools import cache, lru_cache
from pathlib import Path
from typing import Any

from rosbags.interfaces import Nodetype
from rosbags.typesys import Stores, get_types_from_idl, get_types_from_msg, get_typestore
from rosbags.typesys.store import Typestore

from steering_bringup.bags.errors import BagError

PACKAGE = "steering_msgs"
UNKNOWN_HASH = "RIHS01_0"
_SECTION = "=" * 80 + "\n"
_SEPARATOR = re.compile(r"^={3,}[ \t]*$", re.MULTILINE)
_IDL = re.compile(r"^\s*module\s+\w+\s*\{", re.MULTILINE)
_IDL_HEAD = re.compile(r"^(?:=+[ \t]*\n)?IDL: .*\n", re.MULTILINE)
_INCLUDE = re.compile(r"^\s*#include.*$", re.MULTILINE)
_BOUNDED_WSTRING = re.compile(r"\bwstring<=\s*\d+")


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
    try:
        return given[msgtype], store.hash_rihs01(msgtype)
    except KeyError:  # it, or a part of it, could not be understood
        return given[msgtype], UNKNOWN_HASH


@cache
def _standard_types() -> Typestore:
    return get_typestore(Stores.ROS2_JAZZY)


def typestore_of(definitions: dict[str, str]) -> Typestore:
    """A type store from the definitions that a bag carries (type -> definition text).

    Definitions that cannot be parsed are left out. A type without a text, and parts that a text
    does not define, are taken from the standard and our own types.
    """
    return _typestore_of(tuple(sorted(definitions.items())))


def parse_definition(msgtype: str, text: str) -> dict[str, Any]:
    """Return type -> (constants, fields), as rosbags has them, of a definition text and its parts.

    .msg text, concatenated or not, and IDL. Empty where the text is empty or cannot be parsed:
    messages of such a type are kept as bytes.
    """
    text = "\n".join(text.splitlines()) + "\n"
    if not text.strip():
        return {}
    try:
        if not _IDL.search(text):
            # Two things that .msg has and rosbags has not: bounds of wide strings, other rules.
            text = _BOUNDED_WSTRING.sub("wstring", _SEPARATOR.sub("=" * 80, text))
            return dict(get_types_from_msg(text, msgtype))
        parts: dict[str, Any] = {}
        for part in _IDL_HEAD.split(_INCLUDE.sub("", text)):
            if _IDL.search(part):
                parts.update(get_types_from_idl(part))
        return parts
    except Exception:  # whatever a parser raises on a damaged text
        return {}


@lru_cache(maxsize=16)
def _typestore_of(definitions: tuple[tuple[str, str], ...]) -> Typestore:
    store = get_typestore(Stores.EMPTY)
    for name, text in definitions:
        types = parse_definition(name, text)
        store.register({n: t for n, t in types.items() if n not in store.fielddefs})
    _add_missing(store, {name for name, text in definitions if not text.strip()})
    return store


def _add_missing(store: Typestore, names: set[str]) -> None:
    """Add ``names``, and the types that others in the store are made of and no text defines."""
    known, done = typestore().fielddefs, set[str]()
    store.register({name: known[name] for name in names if name in known})
    while names := {n for n in store.fielddefs if n not in done}:
        done.update(names)
        parts = {part for name in names for part in _parts(store.fielddefs[name][1])}
        missing = {n for n in parts if n in known and n not in store.fielddefs}
        store.register({name: known[name] for name in missing})


def _parts(fields: Iterable[tuple[str, Any]]) -> Iterator[str]:
    """Yield the names of the types that fields are made of."""
    for _, (kind, detail) in fields:
        if kind in (Nodetype.ARRAY, Nodetype.SEQUENCE):
            kind, detail = detail[0]
        if kind == Nodetype.NAME:
            yield detail
