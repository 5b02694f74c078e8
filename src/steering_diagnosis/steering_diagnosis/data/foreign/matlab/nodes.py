"""What lies below one value of a MAT file: members of an array, or fields with their clock."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from steering_diagnosis.data.foreign.matlab import clocks
from steering_diagnosis.data.foreign.matlab.leaf import Clock
from steering_diagnosis.data.foreign.matlab.values import SPECIAL, properties, text

UNITS = ("Unit", "unit", "Units", "units")
LABELS = ("Name", "name", "Label", "label", "SignalName", "PropagatedName", "blockName")


@dataclass(frozen=True, repr=False)
class Node:
    """One structure, object, map or table. units: of single fields; unit, label: of its data."""

    fields: Mapping[str, Any]
    clock: Clock | None = None
    unit: str = ""
    label: str = ""
    units: Mapping[str, str] = field(default_factory=dict)


def node(value: Any) -> Node | None:
    """Return what has fields, with what these say of each other; None for anything else."""
    if hasattr(value, "columns") and hasattr(value, "index"):
        return _table(value)
    fields = fields_of(value)
    if fields is None:
        return None
    about_time = fields_of(fields.get("TimeInfo")) or {}
    about_data = fields_of(fields.get("DataInfo")) or {}
    clock = clocks.beside(fields, about_time, clocks.TIMES)
    unit = text(about_data.get("Units")) or _first(fields, UNITS)
    label = _first(fields, LABELS)
    if about_time and clock is not None and "Data" in fields:
        # A timeseries, which has no numbers of its own in the file where its time is uniform.
        fields = {"Time": clock.times, "Data": fields["Data"]}
    return Node(fields, clock, unit, label)


def fields_of(value: Any) -> dict[str, Any] | None:
    """Return the fields of a structure, an object or a map by name; None for anything else."""
    if isinstance(value, Mapping):
        return {str(name): item for name, item in value.items()}
    if isinstance(value, np.ndarray) and value.size == 1 and type(value).__name__ not in SPECIAL:
        value = value.flat[0] if value.dtype.names or hasattr(value, "classname") else None
    if isinstance(value, np.void) and value.dtype.names and value.dtype.hasobject:
        return {name: value[name] for name in value.dtype.names}
    return properties(value)


def members(value: Any) -> list[tuple[str, Any]] | None:
    """Return an array's structures, objects or cells, each with its index; None for others."""
    if getattr(value, "classname", "") == "Simulink.SimulationData.Dataset":
        fields = properties(value) or {}
        value = (fields_of(fields.get("Storage")) or fields).get("Elements")
    if not isinstance(value, np.ndarray) or not value.size or type(value).__name__ in SPECIAL:
        return None
    if not value.dtype.hasobject or value.dtype.kind == "T":
        return None
    opening, closing = "()" if value.dtype.names or hasattr(value, "classname") else "{}"
    if value.size == 1 and opening == "(":
        return None
    return [
        (f"{opening}{_index(where, value.shape)}{closing}", value[where])
        for where in sorted(np.ndindex(value.shape), key=lambda where: where[::-1])
    ]


def _table(frame: Any) -> Node:
    """Return the columns of a table; a timetable's row times are their clock."""
    columns = {str(name): frame[name].to_numpy() for name in frame.columns}
    units = frame.attrs.get("varUnits") or frame.attrs.get("VariableUnits") or []
    names = list(clocks.TIMES)
    if frame.index.dtype.kind in "mM":
        rows = str(frame.index.name)
        columns = {rows: frame.index.to_numpy()} | columns
        names = [rows]
    clock = clocks.beside(columns, {}, names)
    return Node(columns, clock, units=dict(zip(map(str, frame.columns), units, strict=False)))


def _first(fields: Mapping[str, Any], names: tuple[str, ...]) -> str:
    return next((found for name in names if (found := text(fields.get(name)))), "")


def _index(where: tuple[int, ...], shape: tuple[int, ...]) -> str:
    """Return MATLAB's index, counted from 1: one number in a row or a column."""
    if sum(n > 1 for n in shape) <= 1:
        return str(max(where) + 1)
    return ",".join(str(n + 1) for n in where)
