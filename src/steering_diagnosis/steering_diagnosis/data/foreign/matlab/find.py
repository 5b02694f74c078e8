"""From a name in the mapping to one vector of the file, with its clock."""

from __future__ import annotations

import re
from dataclasses import dataclass

import numpy as np

from steering_core.errors import BenchError
from steering_core.naming import nearest
from steering_diagnosis.data.foreign.matlab.leaf import Clock, Leaf
from steering_diagnosis.data.foreign.matlab.tree import DATA
from steering_diagnosis.data.foreign.matlab.values import shape

LISTED = 30
"""Names that an error lists at most."""

_INDEX = re.compile(r"\((?:(\d+)(?:,(\d+))?)\)")
_SLICE = re.compile(r"\(([\d,:]*:[\d,:]*)\)$")


@dataclass(frozen=True, repr=False)
class Vector:
    """(n,) numbers as float64. clock: that of the file for them; scale: s per unit, if known."""

    values: np.ndarray
    clock: Clock | None = None
    unit: str = ""
    scale: float | None = None


class Vectors:
    """The vectors of a file, by address or by name. BenchError begins with ``where``."""

    def __init__(self, found: dict[str, Leaf], where: str) -> None:
        self._found, self._where = found, where

    def has_address(self, name: str) -> bool:
        """Return whether a name is an address in the file, and not only what a signal is called."""
        return self._at(name) is not None

    def __getitem__(self, name: str) -> Vector:
        asked = _plain(name)
        cut = _SLICE.search(asked)
        address = self._address(name)
        if address is None:
            raise BenchError(f"{self._where}: {self._unknown(name)}")
        leaf = self._found[address]
        if leaf.array is None:
            raise BenchError(f"{self._where}: '{name}' {leaf.why_not}")
        values = leaf.array
        if cut and asked != address:
            values = self._cut(values, cut[1], name)
        values = np.squeeze(values)
        if values.ndim != 1:
            raise BenchError(
                f"{self._where}: '{name}' is {shape(leaf.array)} numbers: say which, "
                f"as '{_columns(address, leaf.array)}'"
            )
        clock = leaf.about.clock
        if clock is not None and len(clock.times) != len(values):
            clock = None
        return Vector(values.astype(np.float64), clock, leaf.about.unit, leaf.scale)

    def _at(self, name: str) -> str | None:
        asked = _plain(name)
        for form in dict.fromkeys((asked, _SLICE.sub("", asked))):
            pattern = _pattern(form)
            fitting = [address for address in self._found if pattern.fullmatch(_plain(address))]
            if fitting:
                return fitting[0]
        return None

    def _address(self, name: str) -> str | None:
        """Return the address that a name stands for; BenchError where it stands for several."""
        address = self._at(name)
        if address is not None:
            return address
        for form in dict.fromkeys((name.strip(), _SLICE.sub("", name.strip()))):
            called = [a for a, leaf in self._found.items() if _same(leaf.about.label, form)]
            if len(called) > 1:
                raise BenchError(
                    f"{self._where}: {len(called)} vectors are called '{form}': "
                    f"say which, {_several(called)}"
                )
            if called:
                return called[0]
        return None

    def _cut(self, array: np.ndarray, index: str, name: str) -> np.ndarray:
        """Return what '(:,3)' takes out of an array, counted from 1."""
        parts = index.split(",")
        if parts == [":"]:
            return array.ravel(order="F")
        whole = array if array.ndim > 1 else array[:, np.newaxis]
        wrong = len(parts) != whole.ndim or parts.count(":") != 1
        numbers = [slice(None) if part == ":" else int(part or 0) - 1 for part in parts]
        for number, size in zip(numbers, whole.shape, strict=False):
            wrong = wrong or (not isinstance(number, slice) and not 0 <= number < size)
        if wrong:
            raise BenchError(f"{self._where}: '{name}' is no vector of {shape(whole)} numbers")
        return whole[tuple(numbers)]

    def _unknown(self, name: str) -> str:
        asked = _plain(name)
        vectors = {address: leaf for address, leaf in self._found.items() if leaf.array is not None}
        shown = list(dict.fromkeys(_shown(address, leaf) for address, leaf in vectors.items()))
        inside = [text for text in shown if text.startswith(tuple(f"'{asked}{c}" for c in ".({"))]
        if inside:
            return f"'{name}' is no vector: in it are {_several(inside)}"
        if not shown:
            return f"there is no '{name}', and no vector of numbers at all"
        labels = [leaf.about.label for leaf in self._found.values() if leaf.about.label]
        hint = nearest(name, {*self._found, *labels})
        return f"there is no '{name}'{hint}; vectors are {_several(shown)}"


def _plain(address: str) -> str:
    """Return an address without blanks around its signs."""
    return re.sub(r"\s*([.,:(){}\[\]])\s*", r"\1", address.strip())


def _pattern(asked: str) -> re.Pattern[str]:
    """Return what matches an address: '(1)' of what is no array, '(1,3)' in a row, '.Data'."""
    parts, end = [], 0
    for index in _INDEX.finditer(asked):
        first, second = index[1], index[2]
        parts.append(re.escape(asked[end : index.start()]))
        end = index.end()
        forms = {index[0]} if second is None else {index[0], *_in_a_row(first, second)}
        either = "|".join(re.escape(form) for form in sorted(forms))
        parts.append(f"(?:{either})" + ("?" if {first, second} <= {"1", None} else ""))
    data = "|".join(DATA)
    inside = rf"(?:\.signals)?(?:\.(?:{data})){{0,2}}"
    return re.compile("".join(parts) + re.escape(asked[end:]) + inside)


def _in_a_row(first: str, second: str) -> list[str]:
    return [f"({number})" for number, other in ((first, second), (second, first)) if other == "1"]


def _same(label: str, name: str) -> bool:
    """Return whether a label is a name; ControlDesk puts parts of its labels in quotes."""
    return bool(label) and (label == name or label.replace('"', "") == name.replace('"', ""))


def _shown(address: str, leaf: Leaf) -> str:
    name = f"'{address if leaf.is_vector else _columns(address, leaf.array)}'"
    label = leaf.about.label
    return f"{name} ({label})" if label and label not in (address, name.strip("'")) else name


def _columns(address: str, array: np.ndarray | None) -> str:
    """Return how the first vector of a matrix is called, along its longest side."""
    assert array is not None
    longest = int(np.argmax(array.shape))
    return f"{address}({','.join(':' if k == longest else '1' for k in range(array.ndim))})"


def _several(names: list[str]) -> str:
    more = f" and {len(names) - LISTED} more" if len(names) > LISTED else ""
    return ", ".join(names[:LISTED]) + more
