"""Changes to a scenario from the command line: ``--set NAME=VALUE``, ``--set-file``, ``--delay``.

They are written into the scenario's data before it is checked, so every value goes through the
same schema, and an error tells which option it came from.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from pathlib import Path
from typing import Any

import yaml

from steering_bringup.errors import BenchError
from steering_bringup.schema import Scenario
from steering_core.naming import unknown
from steering_core.parameters import ParameterError, flatten, load_parameters
from steering_core.yaml_lines import Document, Place, read_yaml

KINDS = ("manoeuvre", "load")
FILES: tuple[Place, ...] = (
    ("node_set",),
    ("boost_curve",),
    ("parameter_set",),
    *((kind, "file") for kind in KINDS),
)
"""Places of a scenario that may name a file."""
KEYS = tuple(field.alias or name for name, field in Scenario.model_fields.items())


def set_value(document: Document, text: str) -> None:
    """Apply "NAME=VALUE": a parameter by its full name, or a scenario's key with dots."""
    name, sign, value = (part.strip() for part in text.partition("="))
    origin = f"--set {text}"
    if not sign or not name:
        raise BenchError(f"{origin}: write NAME=VALUE, such as mechanics.rack_mass=30")
    try:
        parsed = yaml.safe_load(value)
    except yaml.YAMLError:
        raise BenchError(f"{origin}: '{value}' is not a value") from None
    if parsed is None:
        raise BenchError(f"{origin}: the value is missing")
    merge(document, {name: parsed}, origin)


def set_file(document: Document, path: str) -> None:
    """Apply a file: a part of a scenario, or groups of parameters."""
    given = read_yaml(Path(path))
    if given.data is None:
        return
    if not isinstance(given.data, Mapping):
        raise BenchError(f"{path}: expected a mapping of names to values")
    changes = {key: value for key, value in given.data.items() if key not in ("schema", "name")}
    for key, value in changes.items():
        merge(document, {key: value}, given.where((str(key),)), Path(path).parent)


def set_delay(document: Document, text: str) -> None:
    """Apply "TOPIC->NODE=TICKS"."""
    name, sign, value = (part.strip() for part in text.partition("="))
    if not sign or not value.isdigit() or "->" not in name:
        raise BenchError(
            f"--delay {text}: write TOPIC->NODE=TICKS, such as /driver/torque->plant=1"
        )
    _put(document, ("delays", name), int(value), f"--delay {text}")


def merge(
    document: Document, changes: Mapping[str, Any], origin: str, folder: Path = Path()
) -> None:
    """Write ``changes`` (names with or without dots) into a scenario's data.

    Files that they name are looked for in ``folder``, not beside the scenario.
    """
    for name, value in changes.items():
        first = str(name).split(".", 1)[0]
        if first in KEYS:
            place = tuple(str(name).split("."))
            for inner, leaf in _leaves(place, value):
                _put(document, inner, _found(inner, leaf, folder), origin)
        else:
            _put_parameters(document, str(name), value, origin)


def _found(place: Place, value: Any, folder: Path) -> Any:
    """Return a file's name as seen from anywhere; other values as they are."""
    if isinstance(value, list):
        return [_found(place, each, folder) for each in value]
    is_file = place in FILES and isinstance(value, str) and Path(value).suffix != ""
    return str(Path(folder, value).absolute()) if is_file else value


def _put_parameters(document: Document, name: str, value: Any, origin: str) -> None:
    known = [*load_parameters(), *_scenario_names(document.data)]
    flat = dict(flatten({name: value}))
    for full, number in flat.items():
        if full not in load_parameters():
            raise BenchError(
                f"{origin}: {unknown('name', full, known)} (see 'steer list parameters')"
            )
        _put(document, ("parameters", full), number, origin)


def _put(document: Document, place: Place, value: Any, origin: str) -> None:
    """Write one value; a new kind drops what belonged to the old one."""
    if place[0] == "parameters":
        _flatten_parameters(document)
        place = ("parameters", ".".join(str(part) for part in place[1:]))
    data = document.data
    for part in place[:-1]:
        inner = data.get(part)
        if isinstance(inner, str) and place[0] in KINDS:
            inner = {"kind": inner}
        if not isinstance(inner, dict):
            inner = {}
        data[part] = inner
        data = inner
    if place[0] in KINDS and place[1:] == ("kind",) and data.get("kind") != value:
        data.clear()
    data[place[-1]] = value
    for length in range(1, len(place) + 1):
        document.origins.setdefault(place[:length], origin)
    document.origins[place] = origin


def _flatten_parameters(document: Document) -> None:
    """Bring groups of parameters into flat form, so that a change meets its first value."""
    given = document.data.get("parameters") or {}
    try:
        document.data["parameters"] = dict(flatten(given))
    except ParameterError as error:
        raise BenchError(f"{document.where(('parameters',))}: parameters: {error}") from None


def _leaves(place: Place, value: Any) -> Iterable[tuple[Place, Any]]:
    """Yield the plain values of nested mappings with their places; kinds first."""
    if not isinstance(value, Mapping) or not value:
        yield place, value
        return
    for key in sorted(value, key=lambda key: key != "kind"):
        yield from _leaves((*place, str(key)), value[key])


def _scenario_names(data: Mapping[str, Any]) -> list[str]:
    """Return the names of a scenario that --set takes beside the parameters."""
    inside = [
        f"{key}.{name}" for key in KINDS if isinstance(data.get(key), Mapping) for name in data[key]
    ]
    return [*KEYS, *inside]
