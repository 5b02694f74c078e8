"""From pydantic's errors to one line that names file, line, key and remedy."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

from pydantic import ValidationError

from steering_core.yaml_lines import Document

TEXTS = {
    "missing": "is missing",
    "literal_error": "must be {expected}, got {input!r}",
    "greater_than": "must be greater than {gt:g}, got {input}",
    "greater_than_equal": "must be at least {ge:g}, got {input}",
    "less_than_equal": "must be at most {le:g}, got {input}",
    "finite_number": "must be finite, got {input}",
    "float_type": "must be a number, got {input!r}",
    "int_type": "must be a whole number, got {input!r}",
    "int_from_float": "must be a whole number, got {input!r}",
    "int_parsing": "must be a whole number, got {input!r}",
    "float_parsing": "must be a number, got {input!r}",
    "bool_type": "must be true or false, got {input!r}",
    "bool_parsing": "must be true or false, got {input!r}",
    "string_too_short": "must not be empty",
    "string_pattern_mismatch": "must be lower-case letters, digits and _, got {input!r}",
    "dict_type": "must be a mapping, got {input!r}",
    "model_attributes_type": "must be a mapping, got {input!r}",
    "model_type": "must be a mapping, got {input!r}",
}


def explain(error: ValidationError, document: Document) -> str:
    """Return one line on the first fault: where, which key, what to do."""
    faults = error.errors(include_url=False)
    first = faults[0]
    context = first.get("ctx", {})
    place = list(first["loc"])
    if first["type"] == "fault":
        key = context["key"]
        place += key if isinstance(key, tuple) else [key]
    text = _text(first["type"], first["msg"], first["input"], context)
    written = _written(place, document.data)
    key = "" if written and str(written[-1]) in text else ".".join(map(str, written)) + ": "
    more = f" ({len(faults) - 1} more faults)" if len(faults) > 1 else ""
    return f"{document.where(place)}: {key if written else ''}{text}{more}"


def _text(kind: str, message: str, given: Any, context: Mapping[str, Any]) -> str:
    if kind == "fault":
        return str(context["text"])
    if kind == "value_error":
        return str(context["error"])
    if kind == "string_type":
        return f"must be a text, got {_quoted(given)}"
    if kind in TEXTS:
        return TEXTS[kind].format(input=given, **context)
    return message[:1].lower() + message[1:]


def _quoted(given: Any) -> str:
    """Return what stands in a text's place, and how it becomes one."""
    if given is None:
        return "nothing"
    if isinstance(given, bool):
        return f"{str(given).lower()}, as YAML reads yes, no, on and off: put it in quotes"
    return repr(given) if isinstance(given, list | dict) else f"{given}: put it in quotes"


def _written(place: Sequence[str | int], data: Any) -> list[str | int]:
    """Return the parts of ``place`` that a user writes: without the branches of a union."""
    kept: list[str | int] = []
    for index, part in enumerate(place):
        last = index == len(place) - 1
        inside = part in data if isinstance(data, Mapping) else _is_index(part, data)
        if inside:
            data = data[part]
        if inside or last:
            kept.append(part)
    return kept


def _is_index(part: str | int, data: Any) -> bool:
    return isinstance(part, int) and isinstance(data, Sequence) and part < len(data)
