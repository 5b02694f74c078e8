"""The vectors inside a MAT file's variables, each by its address, with a label and its own clock.

Addresses are MATLAB's: ``log(2).signals.values``, ``data(:,3)``, ``c{1}``, ``run.Speed`` of a
table. What brings its own time: timeseries, timetables, Simulink's structures with time, and
ControlDesk's X and Y.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

MOST_COLUMNS = 1000
"""Of a matrix; more of them are an image or a map, and no channels."""

DEEPEST = 30
"""Levels of structures: objects may hold themselves."""

LABELS = ("Name", "name", "label", "Label", "signalName")
VALUES = ("Data", "data", "values", "Values")
TIMES = ("time", "Time")


@dataclass(frozen=True, repr=False)
class Found:
    """What stands at an address. values: (n,) float64, or None and ``kind`` says what is there.

    label: the file's own name for it. clock: (n,) its instants [s], where it brings them. unit: as
    the file has it.
    """

    values: np.ndarray | None = None
    kind: str = ""
    label: str = ""
    clock: np.ndarray | None = None
    unit: str = ""


Context = Found
"""What is known from further out: label, clock and unit; no values."""


def walk(content: Mapping[str, Any]) -> dict[str, Found]:
    """Return everything in a file's variables by its address."""
    found: dict[str, Found] = {}
    for name, value in content.items():
        for address, item in _walk(name, value, Found(), DEEPEST):
            found.setdefault(address, item)
    return found


def _walk(at: str, value: Any, known: Context, depth: int) -> Iterator[tuple[str, Found]]:
    if depth == 0:
        return
    properties = getattr(value, "properties", None)
    if isinstance(properties, Mapping):
        yield from _object(at, value, properties, known, depth)
    elif _is_frame(value):
        yield from _frame(at, value, known)
    elif isinstance(value, Mapping):
        yield from _fields(at, dict(value), known, depth)
    elif hasattr(value, "toarray"):
        yield from _numbers(at, np.asarray(value.toarray()), known)
    elif isinstance(value, np.ndarray):
        yield from _array(at, value, known, depth)
    else:
        yield at, Found(kind=_kind(value))


def _array(at: str, value: np.ndarray, known: Context, depth: int) -> Iterator[tuple[str, Found]]:
    if value.dtype.names is not None:
        for place, element in _elements(at, value, "({})"):
            fields = {name: element[name] for name in value.dtype.names or ()}
            yield from _fields(place, fields, known, depth)
    elif value.dtype.kind == "O":
        for place, element in _elements(at, value, "{{{}}}"):
            yield from _walk(place, element, known, depth - 1)
        if value.size == 1:
            # Some writers wrap a value that is no cell.
            yield from _walk(at, value.reshape(-1)[0], known, depth - 1)
    else:
        yield from _numbers(at, value, known)


def _elements(at: str, value: np.ndarray, form: str) -> Iterator[tuple[str, Any]]:
    """Return the elements in MATLAB's order, counted from 1; a single structure has no number."""
    flat = value.reshape(-1, order="F")
    single = len(flat) == 1 and form.startswith("(")
    for i, element in enumerate(flat, start=1):
        yield (at if single else at + form.format(i)), element


def _fields(
    at: str, fields: dict[str, Any], known: Context, depth: int
) -> Iterator[tuple[str, Found]]:
    """Return what a structure holds, with the time and the label that it brings to its parts."""
    label = next((t for n in LABELS if (t := _text(fields.get(n)))), known.label)
    unit = next((t for n in ("Unit", "unit", "Units") if (t := _text(fields.get(n)))), known.unit)
    times = [_vector(fields[n]) for n in TIMES if n in fields]
    clock = next((t for t in times if t is not None and len(t) > 1), known.clock)
    inside = Found(label=label, clock=clock, unit=unit)
    axes = _axes(fields)
    for name, value in fields.items():
        place = f"{at}.{name}" if at else name
        if name == "Y" and axes:
            yield from _by_axis(place, value, axes, inside, depth)
        elif name in VALUES:
            yield from _walk(place, value, inside, depth - 1)
        else:
            yield from _walk(place, value, Found(clock=clock), depth - 1)


def _axes(fields: Mapping[str, Any]) -> list[np.ndarray | None]:
    """Return ControlDesk's axes of time, X(k).Data, where a structure has them."""
    x = fields.get("X")
    if not (isinstance(x, np.ndarray) and x.dtype.names and "Data" in x.dtype.names):
        return []
    return [_vector(element["Data"]) for element in x.reshape(-1, order="F")]


def _by_axis(
    at: str, value: Any, axes: list[np.ndarray | None], known: Context, depth: int
) -> Iterator[tuple[str, Found]]:
    """Return ControlDesk's signals, each with the axis that its XIndex names."""
    if not (isinstance(value, np.ndarray) and value.dtype.names):
        yield from _walk(at, value, known, depth - 1)
        return
    for place, element in _elements(at, value, "({})"):
        fields = {name: element[name] for name in value.dtype.names or ()}
        index = _vector(fields.get("XIndex"))
        which = int(index[0]) - 1 if index is not None and len(index) else 0
        clock = axes[which] if 0 <= which < len(axes) else None
        yield from _fields(place, fields, Found(clock=clock), depth - 1)


def _object(
    at: str, value: Any, properties: Mapping[str, Any], known: Context, depth: int
) -> Iterator[tuple[str, Found]]:
    """Return what an object holds: a timeseries' data at its own address, the rest by property."""
    fields = {name.rstrip("_"): held for name, held in properties.items()}
    name = str(getattr(value, "classname", "object"))
    if not fields:
        yield at, Found(kind=f"an object of class {name} that cannot be read")
        return
    if "Data" in fields:
        clock = _vector(fields.get("Time"))
        clock = clock if clock is not None and len(clock) else _counted(fields.get("TimeInfo"))
        label = _text(fields.get("Name")) or known.label
        about = Found(label=label, clock=clock, unit=_unit(fields.get("DataInfo")))
        yield from _walk(at, fields["Data"], about, depth - 1)
        if clock is not None:
            yield f"{at}.Time", Found(clock)
        return
    if (label := _text(fields.get("Name"))) and "Values" in fields:
        yield from _walk(f"{at}.Values", fields["Values"], Found(label=label), depth - 1)
        return
    yield from _fields(at, fields, known, depth)


def _counted(info: Any) -> np.ndarray | None:
    """Return the instants of a timeseries that has only start, step and number of them."""
    properties = getattr(info, "properties", None)
    if not isinstance(properties, Mapping):
        return None
    given = {n.rstrip("_"): _vector(v) for n, v in properties.items()}
    start, step, count = (given.get(n) for n in ("Start", "Increment", "Length"))
    if start is None or step is None or count is None or not (len(step) and len(count)):
        return None
    return np.asarray((start[0] if len(start) else 0.0) + step[0] * np.arange(int(count[0])))


def _unit(info: Any) -> str:
    properties = getattr(info, "properties", None)
    if not isinstance(properties, Mapping):
        return ""
    return _text(properties.get("Units") or properties.get("Unit") or properties.get("Units_"))


def _is_frame(value: Any) -> bool:
    return hasattr(value, "columns") and hasattr(value, "index")


def _frame(at: str, frame: Any, known: Context) -> Iterator[tuple[str, Found]]:
    """Return the columns of a table; a timetable's rows have times."""
    index = frame.index.to_numpy()
    clock = _seconds(index) if index.dtype.kind in "mM" else known.clock
    if index.dtype.kind in "mM":
        yield f"{at}.{frame.index.name or 'Time'}", Found(clock)
    for name in frame.columns:
        about = Found(label=str(name), clock=clock)
        values = frame[name].to_numpy()
        if values.dtype.kind == "O" and len(values) and np.ndim(values[0]):
            values = np.stack([np.ravel(row) for row in values])
        yield from _numbers(f"{at}.{name}", np.asarray(values), about)


def _numbers(at: str, value: np.ndarray, known: Context) -> Iterator[tuple[str, Found]]:
    """Return a vector, or the columns of a matrix."""
    if value.dtype.kind in "mM":
        value = _seconds(value)
    if value.dtype.kind not in "fiub":
        yield at, Found(kind=_kind(value))
        return
    value = np.squeeze(value)
    if value.ndim <= 1:
        yield at, replace(known, values=np.atleast_1d(value).astype(np.float64))
    elif value.ndim == 2 and value.shape[1] <= MOST_COLUMNS:
        for k in range(value.shape[1]):
            yield f"{at}(:,{k + 1})", replace(known, values=value[:, k].astype(np.float64))
        yield at, Found(kind=f"a matrix of {value.shape[0]} x {value.shape[1]}: give a column")
    else:
        yield at, Found(kind=f"an array of {' x '.join(map(str, value.shape))}")


def _seconds(value: np.ndarray) -> np.ndarray:
    """Return durations, or instants from the first one, in seconds."""
    if value.dtype.kind == "M":
        value = value - value.reshape(-1)[0] if value.size else value.astype("m8[ns]")
    known = ~np.isnat(value)
    return np.where(known, value / np.timedelta64(1, "ns") * 1e-9, np.nan)


def _vector(value: Any) -> np.ndarray | None:
    """Return a value as numbers, (n,); None where it is none."""
    if not isinstance(value, np.ndarray):
        value = np.asarray(value)
    while value.dtype.kind == "O" and value.size == 1:
        value = np.asarray(value.reshape(-1)[0])
    if value.dtype.kind in "mM":
        return _seconds(value).reshape(-1)
    if value.dtype.kind not in "fiub" or np.squeeze(value).ndim > 1:
        return None
    return value.reshape(-1).astype(np.float64)


def _text(value: Any) -> str:
    """Return a text, "" where a value is none."""
    if isinstance(value, np.ndarray):
        while value.dtype.kind == "O" and value.size == 1:
            value = np.asarray(value.reshape(-1)[0])
        if value.dtype.kind not in "US" or value.size != 1:
            return ""
        value = value.reshape(-1)[0]
    return str(value).strip() if isinstance(value, str) else ""


def _kind(value: Any) -> str:
    if isinstance(value, np.ndarray):
        return {"c": "complex numbers", "U": "text", "S": "text"}.get(
            value.dtype.kind, "no numbers"
        )
    return "text" if isinstance(value, str) else f"{type(value).__name__}, no numbers"
