"""The data sheet and the parameter sets made from it.

The YAML data sheet is the only list of parameters: names, values, units, tolerances and sources
are written there once. A parameter set is a data sheet with some values replaced; every value is
checked when the set is made.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace
from functools import cache, lru_cache
from importlib import resources
from pathlib import Path
from typing import Any

import numpy as np
import yaml

from steering_core.naming import unknown
from steering_core.plain_yaml import plain


class ParameterError(ValueError):
    """A parameter that does not exist, or a value that cannot be."""


@dataclass(frozen=True)
class Info:
    """One line of the data sheet.

    value: nominal, in SI units. tolerance: relative, two standard deviations; 0 means exact.
    minimum: smallest value allowed; None means that the value must be greater than zero.
    """

    value: float
    unit: str
    source: str
    tolerance: float = 0.0
    minimum: float | None = None

    def checked(self, name: str, value: Any) -> float:
        """Return ``value`` as a float, or raise ParameterError saying why it cannot be."""
        try:
            number = float(value)
        except (TypeError, ValueError):
            raise ParameterError(f"{name}: '{value}' is not a number [{self.unit}]") from None
        if not math.isfinite(number):
            raise ParameterError(f"{name} must be finite, got {number}")
        if self.minimum is None and number <= 0.0:
            raise ParameterError(f"{name} must be greater than 0 {self.unit}, got {number:g}")
        if self.minimum is not None and number < self.minimum:
            raise ParameterError(
                f"{name} must be at least {self.minimum:g} {self.unit}, got {number:g}"
            )
        return number


@dataclass(frozen=True)
class ParameterSet:
    """Checked parameters under names such as ``mechanics.rack_mass``. Immutable."""

    sheet: Mapping[str, Info]
    values: Mapping[str, float]

    def __getitem__(self, name: str) -> float:
        return self.values[self._known(name)]

    def __iter__(self) -> Iterator[str]:
        return iter(self.values)

    def info(self, name: str) -> Info:
        """Return the data sheet's line for ``name``."""
        return self.sheet[self._known(name)]

    def flat(self) -> dict[str, float]:
        """Return all values under their full names."""
        return dict(self.values)

    def group(self, group: str) -> dict[str, float]:
        """Return the values of one group, such as ``driver``, under their short names."""
        found = {short: self.values[n] for n, short in _members(tuple(self.values), group)}
        if not found:
            groups = {name.split(".", 1)[0] for name in self.values}
            raise ParameterError(unknown("parameter group", group, groups))
        return found

    def with_values(self, changes: Mapping[str, Any]) -> ParameterSet:
        """Return a set with ``changes`` (full name to SI value) applied and checked."""
        checked = {name: self.info(name).checked(name, v) for name, v in changes.items()}
        return replace(self, values={**self.values, **checked})

    def changed(self) -> dict[str, float]:
        """Return the values that differ from the data sheet."""
        return {n: v for n, v in self.values.items() if v != self.sheet[n].value}

    def record(self, *groups: str) -> np.ndarray:
        """Return the values of ``groups`` as a structured float64 array of shape (1,).

        Kernels read ``p = par[0]; p.rack_mass``. Names must be unique among the groups.
        """
        merged: dict[str, float] = {}
        for group in groups:
            values = self.group(group)
            twice = merged.keys() & values.keys()
            if twice:
                raise ParameterError(f"{sorted(twice)} in more than one of the groups {groups}")
            merged.update(values)
        return record(merged)

    def _known(self, name: str) -> str:
        if name not in self.sheet:
            raise ParameterError(unknown("parameter", name, self.sheet))
        return name


@lru_cache(maxsize=256)
def _members(names: tuple[str, ...], group: str) -> tuple[tuple[str, str], ...]:
    """Return full and short names of a group's members; a study asks for the same ever again."""
    prefix = group + "."
    return tuple((name, name.removeprefix(prefix)) for name in names if name.startswith(prefix))


def record(values: Mapping[str, float]) -> np.ndarray:
    """Return ``values`` as a structured float64 array of shape (1,), fields in the same order."""
    return np.array([tuple(values.values())], dtype=[(name, np.float64) for name in values])


def load_parameters(name: str | Path = "nominal") -> ParameterSet:
    """Load a parameter set by the name of a shipped one, or from a YAML file.

    A file is a mapping of groups to plain values (or of full names to values) that replaces values
    of the nominal set; ``{value: ..., tolerance: ..., source: ...}`` replaces these as well. Raises
    ParameterError naming the file.
    """
    path = Path(name)
    if str(name) == "nominal":
        return _shipped()
    if str(name) in shipped_sets():
        path = Path(str(resources.files("steering_core"))) / "parameter_sets" / f"{name}.yaml"
    elif path.suffix not in {".yaml", ".yml"}:
        raise ParameterError(unknown("parameter set", str(name), shipped_sets()))
    try:
        content = plain(path.read_text(encoding="utf-8"))
    except (OSError, UnicodeDecodeError, yaml.YAMLError) as error:
        raise ParameterError(f"cannot read the parameter set {path}: {error}") from None
    try:
        nominal = _shipped()
        return _with_lines(nominal, content).with_values(dict(flatten(content)))
    except ParameterError as error:
        raise ParameterError(f"{path}: {error}") from None


def _with_lines(nominal: ParameterSet, content: Any) -> ParameterSet:
    """Return the set with the tolerances and sources that a file gives for its own values."""
    sheet = dict(nominal.sheet)
    for name, line in flatten(content, whole=True):
        if not isinstance(line, Mapping):
            continue
        info = nominal.info(name)
        tolerance = line.get("tolerance", info.tolerance)
        if isinstance(tolerance, bool) or not isinstance(tolerance, (int, float)):
            raise ParameterError(f"{name}: tolerance '{tolerance}' is not a number")
        if not 0.0 <= tolerance < 1.0:
            raise ParameterError(f"{name}: tolerance must be from 0 to 1, got {tolerance:g}")
        sheet[name] = replace(
            info,
            tolerance=float(tolerance),
            source=str(line.get("source", info.source)),
        )
    return replace(nominal, sheet=sheet)


def shipped_sets() -> list[str]:
    """Return the names of the parameter sets that come with the bench."""
    folder = resources.files("steering_core") / "parameter_sets"
    return sorted(f.name.removesuffix(".yaml") for f in folder.iterdir() if f.name.endswith("yaml"))


def flatten(content: Any, whole: bool = False) -> Iterator[tuple[str, Any]]:
    """Yield (full name, value) of a mapping of groups.

    ``{value: ...}`` stands for its value, or for itself with ``whole``.
    """
    if not isinstance(content, Mapping):
        raise ParameterError("a parameter set is a mapping of groups to parameters")
    for key, entry in content.items():
        if isinstance(entry, Mapping) and "value" not in entry:
            inner = flatten(entry, whole)
            yield from ((f"{key}.{name}", value) for name, value in inner)
        elif isinstance(entry, Mapping) and not whole:
            yield str(key), entry["value"]
        else:
            yield str(key), entry


@cache
def _shipped() -> ParameterSet:
    text = (resources.files("steering_core") / "parameter_sets" / "nominal.yaml").read_text("utf-8")
    sheet = {
        f"{group}.{parameter}": Info(**line)
        for group, lines in plain(text).items()
        for parameter, line in lines.items()
    }
    values = {name: info.checked(name, info.value) for name, info in sheet.items()}
    return ParameterSet(sheet, values)
