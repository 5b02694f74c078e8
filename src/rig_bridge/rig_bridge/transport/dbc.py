"""Reading a DBC file (or KCD, SYM, ARXML), and what of it both ends must have in common."""

from __future__ import annotations

import logging
from collections.abc import Mapping
from pathlib import Path

import cantools
from cantools.database.can import Database, Message

from rig_bridge.transport.dbc_text import blocks, definitions, text_of
from steering_core.errors import BenchError

# That two messages share a name or an identifier is checked for those that the rig uses.
logging.getLogger("cantools").setLevel(logging.ERROR)
FORMATS = {".kcd": "kcd", ".sym": "sym", ".arxml": "arxml"}
STANDARD = 0x7FF
"""Largest identifier of 11 bits."""


class Messages(Database):
    """The messages of a file that can be read; ``faults``: why others cannot, by name."""

    def __init__(self, messages: list[Message], faults: Mapping[str, str]) -> None:
        super().__init__(messages, strict=False)
        self.faults = dict(faults)


def load_dbc(path: Path) -> Messages:
    """Read a DBC file, or one that cantools knows by its suffix (.kcd, .sym, .arxml).

    A message with a fault costs that message only. BenchError names a file that is none of these.
    """
    try:
        data = path.read_bytes()
    except FileNotFoundError:
        raise BenchError(f"there is no DBC file '{path}'") from None
    except OSError as error:
        raise BenchError(f"cannot read the DBC file '{path}': {error.strerror}") from None
    kind = FORMATS.get(path.suffix.lower(), "dbc")
    try:
        text = text_of(data)
        return _read_dbc(text) if kind == "dbc" else Messages(_read(text, kind, strict=False), {})
    except (cantools.database.errors.Error, ValueError) as error:
        raise BenchError(f"cannot read the DBC file '{path}': {_reason(error)}") from None


def _read(text: str, kind: str, *, strict: bool) -> list[Message]:
    database = cantools.database.load_string(text, kind, strict=strict)
    if not isinstance(database, Database):
        raise ValueError("it describes no CAN bus")
    return database.messages


def _read_dbc(text: str) -> Messages:
    """Read the whole file, or message by message where something in it is wrong."""
    try:
        return Messages(_read(text, "dbc", strict=True), {})
    except cantools.database.errors.Error:
        if not (found := blocks(text)):
            raise
    shared = definitions(text)
    messages: list[Message] = []
    faults: dict[str, str] = {}
    for name, block in found:
        try:
            messages += _read(shared + block, "dbc", strict=True)
        except cantools.database.errors.Error as error:
            faults[name] = _reason(error) + _hint(str(error))
    return Messages(messages, faults)


def _reason(error: Exception) -> str:
    return str(error).splitlines()[0].removeprefix("DBC: ").strip('"')


def _hint(reason: str) -> str:
    return "; one of 29 bits has bit 31 set in a DBC file" if "more than 11 bits" in reason else ""


def layout_text(database: Database) -> str:
    """Return the frames' layout as text: identifiers, and each signal's place and scale."""
    rows = []
    for message in sorted(database.messages, key=_order):
        # Larger ones have 29 bits anyway.
        bits = " 29" if message.is_extended_frame and message.frame_id <= STANDARD else ""
        rows.append(f"{message.frame_id}{bits} {message.name} {message.length}")
        for s in sorted(message.signals, key=lambda signal: signal.name):
            place = f"{s.start} {s.length} {s.byte_order} {s.is_signed}"
            kind = " float" if s.is_float else ""
            rows.append(f" {s.name} {place}{kind} {float(s.scale)!r} {float(s.offset)!r}")
    return "\n".join(rows)


def _order(message: Message) -> tuple[int, bool]:
    return message.frame_id, message.is_extended_frame
