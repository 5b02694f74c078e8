"""From a node's ROS parameters to the parameter set and the node's own settings. Pure."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from typing import Any

from steering_core.naming import unknown
from steering_core.parameters import ParameterSet, load_parameters

SET = "parameter_set"


def parameter_set(values: Mapping[str, Any]) -> ParameterSet:
    """Return the set named by ``parameter_set`` (default nominal) with the values that are given.

    ``values``: flat names as on the data sheet ("mechanics.rack_mass"); others are passed over.
    Raises ``ParameterError`` naming an unknown or impossible value.
    """
    base = load_parameters(values.get(SET, "nominal"))
    groups = {name.split(".")[0] for name in base}
    return base.with_values({n: v for n, v in values.items() if n.split(".")[0] in groups})


def description(name: str) -> str:
    """Return what a data sheet parameter is, its unit at the end; empty for other names."""
    sheet = load_parameters()
    if name not in sheet:
        return ""
    info = sheet.info(name)
    return f"{info.source} [{info.unit}]"


def effects_of(values: Mapping[str, Any]) -> dict[str, dict[str, float]]:
    """Return the effects among ``values`` ("effects.entrained_air.air_fraction"), by name."""
    effects: dict[str, dict[str, float]] = {}
    for name, value in values.items():
        first, *rest = name.split(".")
        if first == "effects":
            if len(rest) != 2:
                raise ValueError(f"'{name}' is not written effects.EFFECT.PARAMETER")
            effects.setdefault(rest[0], {})[rest[1]] = value
    return effects


def check_own(values: Mapping[str, Any], known: Iterable[str], sections: Iterable[str]) -> None:
    """Raise ``ValueError`` for a parameter that is neither on the data sheet nor the node's own.

    ``known``: full names; ``sections``: prefixes whose entries are checked by who reads them.
    """
    names = {SET, *known}
    sections = {*sections, *(name.split(".")[0] for name in load_parameters())}
    for name in values:
        if name not in names and name.split(".")[0] not in sections:
            raise ValueError(unknown("parameter", name, [*names, *sections]))
