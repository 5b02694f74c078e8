"""What two runs were made with, and where that differs."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from steering_bringup.bags import Trace

# Differ from run to run without meaning anything for the result.
_VOLATILE = ("started", "domain")


def flatten(data: Any, prefix: str = "") -> dict[str, Any]:
    """Nested mappings as one with dotted names; lists are values."""
    if not isinstance(data, Mapping):
        return {prefix: data}
    flat: dict[str, Any] = {}
    for key, value in data.items():
        flat.update(flatten(value, f"{prefix}.{key}" if prefix else str(key)))
    return flat


def differing(first: Trace, second: Trace) -> list[tuple[str, Any, Any]]:
    """(name, first's, second's) of all metadata that differ; None where one has none."""
    a, b = flatten(first.run), flatten(second.run)
    names = [*a, *[name for name in b if name not in a]]
    return [
        (name, a.get(name), b.get(name))
        for name in names
        if a.get(name) != b.get(name) and name.split(".")[0] not in _VOLATILE
    ]
