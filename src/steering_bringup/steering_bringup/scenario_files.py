"""Finding and reading scenarios and node sets: shipped ones by name, others by file."""

from __future__ import annotations

from pathlib import Path
from typing import Any, TypeVar

from pydantic import ValidationError

from steering_bringup.errors import BenchError
from steering_bringup.schema import NodeSet, Scenario
from steering_bringup.shipped import shipped
from steering_core.naming import unknown
from steering_core.strict import Strict
from steering_core.validation import explain
from steering_core.yaml_lines import Document, read_yaml

Model = TypeVar("Model", bound=Strict)


def find(what: str, name: str) -> Path:
    """Return the file of a shipped name or of a path; BenchError suggests the nearest name."""
    known = shipped(what)
    if name in known:
        return known[name]
    path = Path(name)
    if path.suffix in (".yaml", ".yml") or path.is_file():
        if not path.is_file():
            raise BenchError(f"there is no {what} file '{name}'")
        return path
    raise BenchError(f"{unknown(what, name, known)} (or give a .yaml file; see 'steer list')")


def open_scenario(name: str) -> Document:
    """Return a scenario's data as written, named after its file where it has no name."""
    path = find("scenario", name)
    document = read_yaml(path)
    if not isinstance(document.data, dict):
        raise BenchError(f"{path}: a scenario is a mapping; see 'steer list scenarios'")
    document.data.setdefault("name", path.stem)
    return document


def check_scenario(document: Document, folder: Path) -> Scenario:
    """Return the checked scenario; files that it names are looked for in ``folder``."""
    return _check(Scenario, document, folder)


def load_scenario(name: str) -> Scenario:
    """Return a scenario by shipped name or file."""
    return check_scenario(open_scenario(name), find("scenario", name).parent)


def load_node_set(name: str) -> NodeSet:
    """Return a node set by shipped name or file."""
    path = find("node set", name)
    return _check(NodeSet, read_yaml(path), path.parent)


def _check(model: type[Model], document: Document, folder: Path) -> Model:
    try:
        return model.model_validate(document.data, context={"folder": str(folder)})
    except ValidationError as error:
        raise BenchError(explain(error, document)) from None


def restore(model: type[Model], data: Any, origin: str) -> Model:
    """Return a model from the data that ``model_dump`` gave, such as a bag's metadata."""
    return _check(model, Document(origin, data), Path())
