"""What a message type means, however its text is written: names, kinds and sizes of its fields.

Comments, constants, default values and the spelling of a kind (``char`` and ``byte`` are one
unsigned byte) are not part of it. Pure.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

from rosbags.interfaces import Nodetype

FILLER = "structure_needs_at_least_one_member"
"""The field that ROS gives to a message without any."""

ONE, ARRAY, BOUNDED, UNBOUNDED = range(4)
KINDS = {Nodetype.ARRAY: ARRAY, Nodetype.SEQUENCE: UNBOUNDED}
BYTES = {"char": "uint8", "byte": "uint8", "octet": "uint8", "boolean": "bool"}
PER_CARDINALITY = 48
"""Type numbers of ROS (type_description_interfaces/msg/FieldType) repeat after so many."""

NUMBERS = {
    2: "int8",
    3: "uint8",
    4: "int16",
    5: "uint16",
    6: "int32",
    7: "uint32",
    8: "int64",
    9: "uint64",
    10: "float32",
    11: "float64",
    12: "float128",
    13: "uint8",
    14: "wchar",
    15: "bool",
    16: "uint8",
    17: "string",
    18: "wstring",
    21: "string",
    22: "wstring",
}
NESTED = 1


@dataclass(frozen=True)
class Field:
    """A field: ``kind`` is a primitive's name or the fields of a nested message.

    ``size``: of an array, or the bound of a sequence; ``text``: the bound of a string; 0: none.
    """

    name: str
    kind: str | tuple[Field, ...]
    cardinality: int = ONE
    size: int = 0
    text: int = 0


def fields_of_definition(msgtype: str, types: Mapping[str, Any]) -> tuple[Field, ...]:
    """Return the fields of ``msgtype`` out of rosbags' parsed ``types``; KeyError names a part."""
    made = []
    for name, (node, detail) in types[msgtype][1]:
        cardinality, size = KINDS.get(node, ONE), 0
        if cardinality != ONE:
            (node, detail), size = detail
            cardinality = BOUNDED if cardinality == UNBOUNDED and size else cardinality
        made.append(_field(name, node, detail, cardinality, size, types))
    return tuple(field for field in made if field.name != FILLER)


def _field(
    name: str, node: Any, detail: Any, cardinality: int, size: int, types: Mapping[str, Any]
) -> Field:
    if node == Nodetype.NAME and detail.rpartition("/")[2] == "wstring":
        return Field(name, "wstring", cardinality, size)  # rosbags takes it for a message
    if node == Nodetype.NAME:
        return Field(name, fields_of_definition(detail, types), cardinality, size)
    kind, bound = detail
    return Field(name, BYTES.get(kind, kind), cardinality, size, bound)


def fields_of_description(description: Mapping[str, Any]) -> tuple[Field, ...]:
    """Return the fields of a ROS type description (the JSON file that is installed with a type)."""
    main = description["type_description"]
    parts = {part["type_name"]: part for part in description["referenced_type_descriptions"]}
    return _described(main, parts)


def _described(main: Mapping[str, Any], parts: Mapping[str, Any]) -> tuple[Field, ...]:
    made = []
    for entry in main["fields"]:
        kind = entry["type"]
        cardinality, number = divmod(kind["type_id"], PER_CARDINALITY)
        inner: str | tuple[Field, ...] = NUMBERS.get(number, str(number))
        if number == NESTED:
            inner = _described(parts[kind["nested_type_name"]], parts)
        made.append(
            Field(entry["name"], inner, cardinality, kind["capacity"], kind["string_capacity"])
        )
    return tuple(field for field in made if field.name != FILLER)


def first_difference(theirs: tuple[Field, ...], ours: tuple[Field, ...], prefix: str = "") -> str:
    """Return where messages made as ``theirs`` cannot be taken as ``ours``; empty: nowhere."""
    for one, other in zip(theirs, ours, strict=False):
        name = prefix + one.name
        if one.name != other.name:
            return f"'{name}' there, '{prefix}{other.name}' here"
        if isinstance(one.kind, tuple) and isinstance(other.kind, tuple):
            inner = first_difference(one.kind, other.kind, f"{name}.")
            if inner:
                return inner
        if not _fits(one, other):
            return f"'{name}' is {_told(one)} there, {_told(other)} here"
    if len(theirs) != len(ours):
        longer, place = (theirs, "there") if len(theirs) > len(ours) else (ours, "here")
        return f"'{prefix}{longer[min(len(theirs), len(ours))].name}' only {place}"
    return ""


def _fits(one: Field, other: Field) -> bool:
    if isinstance(one.kind, tuple) != isinstance(other.kind, tuple):
        return False
    if not isinstance(one.kind, tuple) and one.kind != other.kind:
        return False
    if other.text and not 0 < one.text <= other.text:
        return False  # a longer text would not be taken
    if one.cardinality in (BOUNDED, UNBOUNDED) and other.cardinality == UNBOUNDED:
        return True
    if one.cardinality == other.cardinality == BOUNDED:
        return one.size <= other.size
    return (one.cardinality, one.size) == (other.cardinality, other.size)


def _told(field: Field) -> str:
    kind = "a message" if isinstance(field.kind, tuple) else field.kind
    text = f"<={field.text}" if field.text else ""
    after = ("", f"[{field.size}]", f"[<={field.size}]", "[]")[field.cardinality]
    return f"{kind}{text}{after}"
