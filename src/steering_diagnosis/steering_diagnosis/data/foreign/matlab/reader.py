"""The mapped channels of a MAT file, by address or by the file's own label."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from steering_core.errors import BenchError
from steering_core.naming import unknown
from steering_diagnosis.data.foreign.matlab.content import load
from steering_diagnosis.data.foreign.matlab.walk import Found, walk
from steering_diagnosis.data.foreign.raw import Raw
from steering_diagnosis.data.mapping import Mapping

FEWEST = 2
"""Numbers that make a vector: what has fewer is no channel, and is not listed."""

LISTED = 40
"""Addresses that an error lists."""


def read_matlab(path: Path, mapping: Mapping) -> dict[str, Raw]:
    """Read vectors of a MAT file, version 4 to 7.3.

    A channel's time is the mapping's ``time``, or what the file says of this channel where there is
    no ``time`` or it is another one's. BenchError names what is missing, and what there is.
    """
    content = walk(load(path))
    time = _one(content, mapping.time, path).values if mapping.time else None
    return {
        name: _channel(content, channel.source, time, mapping.time, path)
        for name, channel in mapping.channels.items()
    }


def _channel(
    content: dict[str, Found], source: str, time: np.ndarray | None, named: str, path: Path
) -> Raw:
    found = _one(content, source, path)
    assert found.values is not None
    values, own = found.values, found.clock
    if time is not None and len(time) == len(values):
        return Raw(values, time, found.unit)
    if own is not None and len(own) == len(values):
        return Raw(values, own, found.unit)
    if time is not None:
        raise BenchError(f"'{path}': '{source}' has {len(values)} values, '{named}' {len(time)}")
    return Raw(values, None, found.unit)


def _one(content: dict[str, Found], name: str, path: Path) -> Found:
    """Return what a mapping's name stands for: an address, or a label that one vector has."""
    found = content.get(name)
    if found is not None and found.values is not None and len(found.values) >= FEWEST:
        return found
    labelled = {a: f for a, f in content.items() if f.label == name and f.values is not None}
    if len(labelled) == 1:
        return next(iter(labelled.values()))
    if labelled:
        raise BenchError(
            f"'{path}': several vectors are called '{name}': say which, {_listed(list(labelled))}"
        )
    if found is not None:
        what = found.kind or f"{len(found.values if found.values is not None else ())} number"
        raise BenchError(f"'{path}': '{name}' holds {what}, no vector; {_there(content)}")
    names = [a for a, f in content.items() if f.values is not None and len(f.values) >= FEWEST]
    names += sorted({f.label for f in content.values() if f.label and f.values is not None})
    if not names:
        raise BenchError(f"'{path}': there is no '{name}'; {_there(content)}")
    raise BenchError(f"'{path}': {unknown('vector', name, names[:LISTED])}{_more(names)}")


def _more(names: list[str]) -> str:
    return f", and {len(names) - LISTED} more" if len(names) > LISTED else ""


def _there(content: dict[str, Found]) -> str:
    """Return in words what vectors there are, or what there is in their place."""
    names = [a for a, f in content.items() if f.values is not None and len(f.values) >= FEWEST]
    if names:
        return f"vectors are {_listed(names)}"
    others = [f"{a} ({f.kind or 'one number'})" for a, f in content.items()]
    return f"no vector is in the file: {_listed(others) if others else 'it holds no variable'}"


def _listed(names: list[str]) -> str:
    return ", ".join(names[:LISTED]) + _more(names)
