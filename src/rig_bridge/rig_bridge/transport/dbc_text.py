"""The text of a DBC file, cut into what belongs to one message, so that each is read by itself."""

from __future__ import annotations

import codecs
import re
from collections import defaultdict
from collections.abc import Iterator

KEYWORD = re.compile(r"[ \t]*((?:[A-Z]+_)+|VERSION)(?=[\s:])")
LONG_TEXTS = ("CM_", "BA_", "BA_DEF_", "BA_DEF_DEF_")
"""Statements whose texts may go over several lines, on which words are no keywords."""

MESSAGE = re.compile(r"\s*BO_\s+(\d+)\s+(\w+)\s*:")
SIGNAL = re.compile(r"\s*SG_\s+(\w+)")
BELONGS = re.compile(
    r"\s*(?:(?:VAL_|SIG_VALTYPE_|SG_MUL_VAL_)\s+(?P<number>\d+)\s+(?P<signal>\w+)"
    r'|BA_\s+"(?P<attribute>\w+)"\s+(?:BO_|SG_)\s+(?P<of>\d+)(?:\s+(?P<part>[A-Za-z_]\w*))?)'
)
ATTRIBUTE = re.compile(r'\s*BA_DEF_(?:DEF_)?\s+(?:(?:BO_|SG_)\s+)?"(\w+)"')
ATTRIBUTES = ("VFrameFormat", "SystemMessageLongSymbol", "SystemSignalLongSymbol")
"""Those that say what a frame is or what its signals are called."""

UNASSIGNED = "VECTOR__INDEPENDENT_SIG_MSG"
"""Vector's name of the place for signals that are in no message."""


def text_of(data: bytes) -> str:
    """Return the text of a file: by its byte order mark, else UTF-8, else cp1252 as is usual."""
    for mark, encoding in (
        (codecs.BOM_UTF8, "utf-8-sig"),
        (codecs.BOM_UTF16_LE, "utf-16"),
        (codecs.BOM_UTF16_BE, "utf-16"),
    ):
        if data.startswith(mark):
            return data.decode(encoding, "replace")
    try:
        return data.decode("utf-8")
    except UnicodeDecodeError:
        return data.decode("cp1252", "replace")


def statements(text: str) -> Iterator[tuple[str, str]]:
    """Give keyword and text of each statement; lines without a keyword belong to the one before."""
    keyword, lines, inside = "", [""], False
    for line in text.splitlines():
        found = None if inside else KEYWORD.match(line)
        if found:
            yield keyword, "\n".join(lines)
            keyword, lines = found[1], [line]
        else:
            lines.append(line)
        if keyword in LONG_TEXTS:
            inside ^= line.replace('\\"', "").count('"') % 2 == 1
    yield keyword, "\n".join(lines)


def definitions(text: str) -> str:
    """Return the definitions of the attributes that say how frames are read."""
    kept = []
    for keyword, statement in statements(text):
        found = ATTRIBUTE.match(statement) if keyword.startswith("BA_DEF_") else None
        if found and found[1] in ATTRIBUTES:
            kept.append(statement)
    return "\n".join(kept) + "\n"


def blocks(text: str) -> list[tuple[str, str]]:
    """Return name and text of each message: signals, value tables, types, multiplexing.

    What refers to a signal that is not there is left out.
    """
    defined = definitions(text)
    messages: list[tuple[str, str, list[str]]] = []
    belonging: dict[str, list[tuple[str | None, str]]] = defaultdict(list)
    for keyword, statement in statements(text):
        if keyword == "BO_":
            number, name = found.groups() if (found := MESSAGE.match(statement)) else ("", "")
            messages.append((number, name, [statement]))
        elif keyword == "SG_" and messages:
            messages[-1][2].append(statement)
        elif (part := BELONGS.match(statement)) and _is_used(part, defined):
            belonging[part["number"] or part["of"]].append(
                (part["signal"] or part["part"], statement)
            )
    return [
        (name, "\n".join([*lines, *_of(belonging[number], lines)]) + "\n")
        for number, name, lines in messages
        if name not in ("", UNASSIGNED)
    ]


def _is_used(part: re.Match[str], defined: str) -> bool:
    name = part["attribute"]
    return name is None or (name in ATTRIBUTES and f'"{name}"' in defined)


def _of(belonging: list[tuple[str | None, str]], lines: list[str]) -> list[str]:
    signals = {found[1] for line in lines if (found := SIGNAL.match(line))}
    return [statement for signal, statement in belonging if signal is None or signal in signals]
