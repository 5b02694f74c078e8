"""Schema models made from the registries of manoeuvres and loads.

A registry maps a kind to a dataclass. Each becomes a model with the dataclass's fields and
defaults; which one applies is told by ``kind``. The dataclass itself checks the values.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import MISSING, fields
from functools import reduce
from operator import or_
from pathlib import Path
from typing import Annotated, Any, ClassVar, Literal, get_type_hints

from pydantic import BeforeValidator, Field, ValidationInfo, create_model, model_validator

from steering_core.naming import unknown
from steering_core.strict import Number, Strict, fault

FILE_KINDS = ("table",)
"""Kinds whose numbers may come from a CSV file, named by ``file`` beside the scenario."""


class Choice(Strict):
    """One kind out of a registry with its values; ``make()`` gives the registry's object."""

    build: ClassVar[Callable[..., Any]]
    kind: str

    @model_validator(mode="before")
    @classmethod
    def _read_file(cls, data: Any, info: ValidationInfo) -> Any:
        """Replace ``file`` by its numbers, so that a scenario in a bag needs no other file."""
        if not isinstance(data, Mapping) or data.get("file") is None:
            return data
        path = Path((info.context or {}).get("folder", "."), str(data["file"]))
        rest = {name: value for name, value in data.items() if name not in ("kind", "file")}
        try:
            made = cls.build(data["kind"], file=path, **rest)
        except ValueError as error:
            raise fault("file", str(error)) from None
        return {"kind": data["kind"], **{f.name: getattr(made, f.name) for f in fields(made)}}

    @model_validator(mode="after")
    def _can_be_made(self) -> Choice:
        try:
            self.make()
        except ValueError as error:
            named = [name for name in type(self).model_fields if f" {name} " in f"{error} "]
            raise (fault(named[0], str(error)) if named else error) from None
        return self

    def values(self) -> dict[str, Any]:
        """Return the values without the kind."""
        return self.model_dump(exclude={"kind", "file"})

    def make(self) -> Any:
        """Return the registry's object; ValueError if the values do not fit together."""
        return type(self).build(self.kind, **self.values())


def choice_of(what: str, registry: Mapping[str, type], build: Callable[..., Any]) -> Any:
    """Return the annotated union of models of ``registry``, told apart by ``kind``."""
    models = [_model(what, kind, made, build) for kind, made in registry.items()]

    def check_kind(value: Any) -> Any:
        data = {"kind": value} if isinstance(value, str) else value
        if isinstance(data, Mapping):
            if "kind" not in data:
                raise ValueError(f"'kind' is missing: one of {', '.join(sorted(registry))}")
            if data["kind"] not in registry:
                raise fault("kind", unknown(what, str(data["kind"]), registry))
        return data

    tagged: Any = Annotated[reduce(or_, models), Field(discriminator="kind")]
    names: Any = Literal[tuple(registry)]  # a kind alone stands for its defaults
    return Annotated[tagged, BeforeValidator(check_kind, json_schema_input_type=tagged | names)]


def _model(what: str, kind: str, made: Any, build: Callable[..., Any]) -> type[Choice]:
    hints = get_type_hints(made)
    entries: dict[str, Any] = {"kind": (Literal[kind], ...)}
    for field in fields(made):
        default = ... if field.default is MISSING else field.default
        entries[field.name] = (_checked_type(hints[field.name]), default)
    if kind in FILE_KINDS:
        entries["file"] = (str | None, Field(None, description="CSV file beside the scenario"))
    name = f"{kind}_{what}".title().replace("_", "")
    model = create_model(name, __base__=Choice, __doc__=made.__doc__, **entries)
    model.build = staticmethod(build)
    return model


def _checked_type(hint: Any) -> Any:
    if hint is float:
        return Number
    return tuple[Number, ...] if hint == tuple[float, ...] else hint
