"""YAML files as plain data, with the origin of every entry for error messages."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any

import yaml

from steering_core.errors import BenchError

Place = tuple[str | int, ...]

MOST_ENTRIES = 100_000
"""Entries of a file, aliases written out; no file that somebody writes has as many."""

LONGEST = 30
"""Characters of a value that a line shows."""

REMEDIES = {
    "'\\t'": ": indent with blanks, not with tabs",
    "cannot start any token": ": put a text that begins with it in quotes",
    "undefined alias": ": put a text that begins with '*' in quotes",
    "mapping values are not allowed": ": put a text with ': ' in it in quotes",
    "expected ',' or '}'": ": put a text with brackets, commas or colons in it in quotes",
    "expected ',' or ']'": ": put a text with brackets, commas or colons in it in quotes",
    "could not find expected ':'": ": a key needs a colon and a blank behind it",
    "but found another document": ": give one, without '---'",
    "expected <block end>": ": is it indented as the lines above?",
    "unexpected end of stream": ": a quote that does not end?",
}
"""Parts of PyYAML's messages to what is mostly meant."""


@dataclass(frozen=True)
class Document:
    """Plain ``data``, its ``name``, and where each place such as ("load", "kind") comes from."""

    name: str
    data: Any
    origins: dict[Place, str] = field(default_factory=dict)

    def where(self, place: Sequence[str | int]) -> str:
        """Return the origin ("file, line n") of the innermost known part of ``place``.

        Parts that the data does not have (a schema's branch names) are passed over; names with
        dots are looked for whole and in parts.
        """
        found: Place = ()
        for part in place:
            if (*found, part) not in self.origins and isinstance(part, str):
                found = self._deepest(found, part.split("."))
            elif (*found, part) in self.origins:
                found = (*found, part)
        return self.origins[found] if found else self.name

    def _deepest(self, found: Place, parts: Sequence[str]) -> Place:
        for part in parts:
            if (*found, part) in self.origins:
                found = (*found, part)
        return found


class _Loader(yaml.SafeLoader):
    """Names what looks like a date or a number and is none, as 2024-13-99, with its line."""

    def __init__(self, text: str, document: Document) -> None:
        super().__init__(text)
        self.document = document

    def construct_object(self, node: yaml.Node, deep: bool = False) -> Any:
        try:
            return super().construct_object(node, deep)
        except (ValueError, KeyError, AttributeError):
            if not isinstance(node, yaml.ScalarNode):
                raise
            kind = node.tag.rpartition(":")[2]
            raise BenchError(
                f"{_line(node, self.document)}: '{node.value[:LONGEST]}' looks like a value of the "
                f"type {kind} and is none: put it in quotes if it is a text"
            ) from None


def read_yaml(path: Path) -> Document:
    """Read one YAML file; BenchError names file and line if it cannot be read.

    Refused are anchors that hold themselves, and aliases that stand for too much.
    """
    text = _text(path)
    document = Document(str(path), None)
    try:
        loader = _Loader(text, document)
        root = loader.get_single_node()
        if root is None:
            return document
        _collect(root, (), document, ())
        return replace(document, data=loader.construct_document(root))
    except yaml.YAMLError as error:
        raise BenchError(_told(path, text, error)) from None
    except RecursionError:
        raise BenchError(f"{path}: its entries stand too deep within each other") from None


def _text(path: Path) -> str:
    try:
        data = path.read_bytes()
    except FileNotFoundError:
        raise BenchError(f"there is no file '{path}'") from None
    except OSError as error:
        raise BenchError(f"cannot read '{path}': {error.strerror}") from None
    try:
        return data.decode("utf-8")
    except UnicodeDecodeError as error:
        line = data.count(b"\n", 0, error.start) + 1
        raise BenchError(
            f"{path}, line {line}: it is not UTF-8 text: save the file as UTF-8 in the editor"
        ) from None


def _told(path: Path, text: str, error: yaml.YAMLError) -> str:
    """Return what is wrong in a YAML file, where, and what is mostly meant."""
    if isinstance(error, yaml.reader.ReaderError):
        line = text.count("\n", 0, error.position) + 1
        return f"{path}, line {line}: the character {chr(error.character)!a} is not allowed in YAML"
    mark = getattr(error, "problem_mark", None)
    where = f", line {mark.line + 1}" if mark else ""
    problem = getattr(error, "problem", None) or "no YAML"
    if problem.startswith("but ") and (context := getattr(error, "context", None)):
        problem = f"{context}, {problem}"
    remedy = next((told for sign, told in REMEDIES.items() if sign in problem), "")
    return f"{path}{where}: {problem}{remedy}"


def _collect(
    node: yaml.Node, place: Place, document: Document, around: tuple[yaml.Node, ...]
) -> None:
    """Note the line of every entry; aliases are followed, as the data hold them once each."""
    if any(node is outer for outer in around):
        raise BenchError(f"{_line(node, document)}: this anchor holds an alias of itself")
    if len(document.origins) > MOST_ENTRIES:
        raise BenchError(
            f"{document.name}: more than {MOST_ENTRIES} entries: do its aliases stand for too much?"
        )
    document.origins[place] = _line(node, document)
    around = (*around, node)
    if isinstance(node, yaml.MappingNode):
        seen: set[str] = set()
        for key_node, value_node in node.value:
            key = str(key_node.value)
            if key in seen:
                raise BenchError(f"{_line(key_node, document)}: '{key}' is given twice")
            seen.add(key)
            _collect(value_node, (*place, key), document, around)
            document.origins[(*place, key)] = _line(key_node, document)
    elif isinstance(node, yaml.SequenceNode):
        for index, item in enumerate(node.value):
            _collect(item, (*place, index), document, around)


def _line(node: yaml.Node, document: Document) -> str:
    return f"{document.name}, line {node.start_mark.line + 1}"
