"""All that a MAT file holds, by the address that MATLAB has for it."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import replace
from typing import Any

import numpy as np

from steering_diagnosis.data.foreign.matlab.leaf import About, Clock, Leaf
from steering_diagnosis.data.foreign.matlab.nodes import Node, fields_of, members, node
from steering_diagnosis.data.foreign.matlab.values import leaf, number

DATA = ("Data", "data", "Values", "values", "Value", "value")
"""Fields that hold what the name, the unit and the time beside them are of."""

DEEPEST = 40
"""Levels of structures in structures that are followed."""

MOST_MEMBERS = 10_000
"""Members of an array above which only '[array.field]' is offered, not each of them."""

Found = tuple[str, Leaf]


def walk(variables: Mapping[str, Any]) -> Iterator[Found]:
    """Yield the address and the content of every array, in the order of the file."""
    for name, value in variables.items():
        yield from _walk(name, value, About(), ())


def _walk(address: str, value: Any, about: About, above: tuple[int, ...]) -> Iterator[Found]:
    """Yield what lies at and below an address. above: identities of what it lies in."""
    if id(value) in above or len(above) > DEEPEST:
        yield address, Leaf(None, about, "lies in itself, or deeper than is followed")
        return
    above = (*above, id(value))
    inside = members(value)
    if inside is not None:
        yield from _joined(address, value, about)
        for index, member in inside if len(inside) <= MOST_MEMBERS else []:
            yield from _walk(f"{address}{index}", member, about, above)
        return
    below = node(value)
    if below is None:
        yield address, leaf(value, about)
    elif not below.fields:
        yield address, Leaf(None, about, "has no fields")
    else:
        yield from _fields(address, below, about, above)


def _fields(address: str, here: Node, about: About, above: tuple[int, ...]) -> Iterator[Found]:
    """Yield what a structure, an object or a table holds."""
    axes = _axes(here.fields)
    for name, child in here.fields.items():
        below = About(here.clock or about.clock, here.units.get(name, ""), "")
        if name in DATA:
            below = replace(below, unit=here.unit or about.unit, label=here.label or about.label)
        elif about.label and not here.label:
            below = replace(below, label=f"{about.label}.{name}")
        if name == "Y" and axes:
            yield from _recorded(f"{address}.Y", child, below, axes, above)
        else:
            yield from _walk(f"{address}.{name}", child, below, above)


def _axes(fields: Mapping[str, Any]) -> list[Clock]:
    """Return the axes of a recording of ControlDesk: X and Y, each with Data."""
    if "X" not in fields or "Y" not in fields:
        return []
    found = []
    for _, axis in members(fields["X"]) or [("", fields["X"])]:
        data = leaf((fields_of(axis) or {}).get("Data"), About())
        if data.array is None or not data.is_vector:
            return []
        found.append(Clock(np.squeeze(data.array).astype(np.float64)))
    return found


def _recorded(
    address: str, signals: Any, about: About, axes: list[Clock], above: tuple[int, ...]
) -> Iterator[Found]:
    """Yield ControlDesk's signals, each with the axis that its XIndex names, from 1."""
    for index, signal in members(signals) or [("", signals)]:
        which = int(number((fields_of(signal) or {}).get("XIndex")) or 1)
        clock = axes[which - 1] if 1 <= which <= len(axes) else None
        yield from _walk(f"{address}{index}", signal, replace(about, clock=clock), above)


def _joined(address: str, value: Any, about: About) -> Iterator[Found]:
    """Yield '[log.angle]': single numbers of an array of structures or of cells, as a vector."""
    if not isinstance(value, np.ndarray) or value.size < 2:
        return
    flat = value.ravel(order="F")
    columns = {f".{name}": flat[name] for name in value.dtype.names or ()} or {"{:}": flat}
    for name, column in columns.items():
        arrays = [np.asarray(item) for item in column]
        if all(array.size == 1 and array.dtype.kind in "fiub" for array in arrays):
            numbers = np.array([array.item() for array in arrays], dtype=np.float64)
            yield f"[{address}{name}]", Leaf(numbers, about)
