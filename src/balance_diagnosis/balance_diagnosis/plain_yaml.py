"""Data as YAML that every reader of YAML and of JSON takes: the library needs neither of them."""

from __future__ import annotations

import json
import math
from collections.abc import Mapping
from typing import Any


def to_text(data: Any) -> str:
    """Return nested mappings, lists, texts and numbers as text, one entry a line.

    A mapping that holds no other one stands on one line. What is not a finite number is null.
    """
    return _text(data, 0) + "\n"


def _text(data: Any, depth: int) -> str:
    if isinstance(data, Mapping):
        entries = [f"{json.dumps(str(k))}: {_text(v, depth + 1)}" for k, v in data.items()]
        return _bracketed(entries, "{}", depth, _flat(data.values()))
    if isinstance(data, list | tuple):
        return _bracketed([_text(v, depth + 1) for v in data], "[]", depth, _flat(data))
    if data is None or isinstance(data, bool | str):
        return json.dumps(data)
    if isinstance(data, int):
        return str(data)
    return _number(float(data))


def _flat(values: Any) -> bool:
    return not any(isinstance(v, Mapping | list | tuple) for v in values)


def _bracketed(entries: list[str], signs: str, depth: int, flat: bool) -> str:
    if flat:
        return signs[0] + ", ".join(entries) + signs[1]
    pad = "  " * (depth + 1)
    return signs[0] + "\n" + ",\n".join(pad + e for e in entries) + "\n" + pad[:-2] + signs[1]


def _number(value: float) -> str:
    """Return a number with a point: YAML 1.1 takes 1e-05 for a text."""
    if not math.isfinite(value):
        return "null"
    text = repr(value)
    mantissa, sign, exponent = text.partition("e")
    return text if not sign or "." in mantissa else f"{mantissa}.0e{exponent}"
