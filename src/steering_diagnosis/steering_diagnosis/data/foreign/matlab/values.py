"""Single values of a MAT file as numpy has them: numbers, texts, instants, or why not."""

from __future__ import annotations

from typing import Any

import numpy as np

from steering_diagnosis.data.foreign.matlab.leaf import About, Leaf
from steering_diagnosis.data.foreign.matlab.load import Unreadable

LARGEST_SPARSE = 1 << 26
"""Numbers of a sparse matrix above which it is not written out in full: half a gigabyte."""

UNREAD = "Read error: "
"""Begins the text that the library puts in the place of a variable that it gives up."""

SPECIAL = ("MatlabFunction", "MatlabEnumerationArray", "EmptyMatStruct")
"""Arrays of the library that are no arrays of numbers, structures or cells."""


def leaf(value: Any, about: About) -> Leaf:
    """Return an array that is neither a structure nor a cell array, as numbers or with a reason."""
    if isinstance(value, Unreadable):
        return Leaf(None, about, f"is damaged: {value.why}")
    if isinstance(value, str):
        why = value.removeprefix(UNREAD)
        return Leaf(None, about, "is a text" if why == value else f"cannot be read: {why}")
    if hasattr(value, "toarray"):
        if np.prod(value.shape, dtype=float) > LARGEST_SPARSE:
            return Leaf(None, about, f"is a sparse matrix of {shape(value)}")
        value = value.toarray()
    special = not isinstance(value, np.ndarray | np.generic) or type(value).__name__ in SPECIAL
    if special or hasattr(value, "classname"):
        return Leaf(None, about, f"is {_kind(value)}")
    return _numbers(np.asarray(value), about)


def _numbers(array: np.ndarray, about: About) -> Leaf:
    kind = array.dtype.kind
    if kind in "UST":
        return Leaf(None, about, "is a text")
    if array.size == 0:
        return Leaf(None, about, "is empty")
    if kind == "c":
        return Leaf(None, about, "holds complex numbers")
    if kind not in "fiubmM":
        return Leaf(None, about, "holds no numbers")
    if array.size == 1:
        return Leaf(None, about, f"is a single number, {array.item()}")
    if kind in "mM":
        return Leaf(seconds(array), about, scale=1.0)
    return Leaf(array, about)


def seconds(array: np.ndarray) -> np.ndarray:
    """Return instants since 1970, or durations, in s; NaN where there is none."""
    ticks = array.astype("M8[ns]" if array.dtype.kind == "M" else "m8[ns]").astype(np.int64)
    return np.where(np.isnat(array), np.nan, ticks * 1e-9)


def properties(value: Any) -> dict[str, Any] | None:
    """Return what an object of MATLAB is made of; None for anything else.

    A class hides properties behind an underscore, and may save a structure in their place, 'any'.
    """
    found = getattr(value, "properties", None)
    if not isinstance(found, dict):
        return None
    saved = found.get("any")
    if isinstance(saved, np.ndarray) and saved.dtype.names and saved.size == 1:
        found = found | {name: saved.flat[0][name] for name in saved.dtype.names}
    return {name.removesuffix("_"): item for name, item in found.items() if item is not saved}


def text(value: Any) -> str:
    """Return a text of one line, also that of an object with a name; "" for anything else."""
    inside = properties(value)
    if inside is not None:
        value = inside.get("Name")
    while isinstance(value, np.ndarray) and value.size == 1:
        value = value.item()
    return value.strip() if isinstance(value, str) else ""


def number(value: Any) -> float | None:
    """Return a single finite number, or None."""
    array = np.asarray(value)
    if array.size != 1 or array.dtype.kind not in "fiub":
        return None
    found = float(array.item())
    return found if np.isfinite(found) else None


def shape(array: Any) -> str:
    """Return the size of an array in words: '6000 x 3'."""
    return " x ".join(str(n) for n in array.shape)


def _kind(value: Any) -> str:
    name = type(value).__name__
    known = {
        "Categorical": "a categorical array",
        "MatlabFunction": "a function handle",
        "MatlabEnumerationArray": "an enumeration",
        "MatlabCanonicalEmpty": "empty",
        "EmptyMatStruct": "an empty structure",
        "Empty": "empty",
        "bytes": "a text",
    }
    if name not in known and isinstance(getattr(value, "classname", None), str):
        return f"an object of class {value.classname}, which only MATLAB can read"
    return known.get(name, f"a {name}, no numbers")
