"""YAML files as plain data, with the origin of every entry for error messages."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import yaml

from steering_core.errors import BenchError

Place = tuple[str | int, ...]


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


def read_yaml(path: Path) -> Document:
    """Read one YAML file; BenchError names file and line if it cannot be read."""
    try:
        text = path.read_text(encoding="utf-8")
    except FileNotFoundError:
        raise BenchError(f"there is no file '{path}'") from None
    except (OSError, UnicodeDecodeError) as error:
        reason = getattr(error, "strerror", None) or "it is not UTF-8 text"
        raise BenchError(f"cannot read '{path}': {reason}") from None
    try:
        root = yaml.compose(text, Loader=yaml.SafeLoader)
        data = yaml.safe_load(text)
    except yaml.YAMLError as error:
        mark = getattr(error, "problem_mark", None)
        where = f", line {mark.line + 1}" if mark else ""
        problem = getattr(error, "problem", None) or "no YAML"
        raise BenchError(f"{path}{where}: {problem}") from None
    document = Document(str(path), data)
    if root is not None:
        _collect(root, (), document)
    return document


def _collect(node: yaml.Node, place: Place, document: Document) -> None:
    document.origins[place] = _line(node, document)
    if isinstance(node, yaml.MappingNode):
        seen: set[str] = set()
        for key_node, value_node in node.value:
            key = str(key_node.value)
            if key in seen:
                raise BenchError(f"{_line(key_node, document)}: '{key}' is given twice")
            seen.add(key)
            _collect(value_node, (*place, key), document)
            document.origins[(*place, key)] = _line(key_node, document)
    elif isinstance(node, yaml.SequenceNode):
        for index, item in enumerate(node.value):
            _collect(item, (*place, index), document)


def _line(node: yaml.Node, document: Document) -> str:
    return f"{document.name}, line {node.start_mark.line + 1}"
