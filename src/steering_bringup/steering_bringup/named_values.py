"""Schema types of parameters and effects: mappings whose names are checked by their registries."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Annotated, Any

from pydantic import BeforeValidator, GetJsonSchemaHandler
from pydantic_core import CoreSchema

from steering_core.parameters import ParameterError, flatten, load_parameters
from steering_core.strict import check_keys, fault, number


def check_parameters(data: Any) -> dict[str, float]:
    """Return flat names and checked values; groups may be written nested."""
    sheet = load_parameters()
    try:
        flat = dict(flatten(data if data is not None else {}))
    except ParameterError as error:
        raise ValueError(str(error)) from None
    checked = {}
    for name, value in flat.items():
        try:
            checked[name] = sheet.info(name).checked(name, number(value))
        except ParameterError as error:
            raise fault(name, str(error)) from None
        except ValueError as error:
            raise fault(name, f"{name} {error}") from None
    return checked


class ParameterSchema:
    """JSON Schema of parameters, made from the data sheet: editors offer names and units."""

    @classmethod
    def __get_pydantic_json_schema__(
        cls, schema: CoreSchema, handler: GetJsonSchemaHandler
    ) -> dict[str, Any]:
        sheet = load_parameters()
        entries: dict[str, Any] = {}
        for name in sheet:
            group, short = name.split(".", 1)
            entry = _entry(sheet.info(name))
            nested = entries.setdefault(
                group, {"type": "object", "properties": {}, "additionalProperties": False}
            )
            nested["properties"][short] = entries[name] = entry
        return {"type": "object", "properties": entries, "additionalProperties": False}


def _entry(info: Any) -> dict[str, Any]:
    limit = {"exclusiveMinimum": 0} if info.minimum is None else {"minimum": info.minimum}
    text = f"{info.unit}; {info.source}; {info.value:g} by default"
    return {"type": "number", "description": text, **limit}


ParameterValues = Annotated[dict[str, float], BeforeValidator(check_parameters), ParameterSchema]


def check_effects(data: Any) -> dict[str, dict[str, float]]:
    """Return checked values of the named effects; what is not named keeps its default."""
    if data is None or data == {}:
        return {}
    if not isinstance(data, Mapping):
        raise ValueError("must be a mapping of effect names to parameters")
    # Only here: the registry imports the compiled kernels, which a scenario without effects spares.
    from steering_plant.effects import EFFECTS

    check_keys("effect", data, EFFECTS)
    return {name: _effect_values(name, EFFECTS[name], values) for name, values in data.items()}


def _effect_values(name: str, effect: Any, values: Any) -> dict[str, float]:
    given = {} if values is None else values
    if not isinstance(given, Mapping):
        raise fault(name, f"effect {name}: must be a mapping of its parameters to values")
    try:
        return effect.values({key: number(value) for key, value in given.items()})
    except ValueError as error:
        raise fault(name, str(error)) from None


class EffectSchema:
    """JSON Schema of effects, made from their registry: editors offer names, bounds and units."""

    @classmethod
    def __get_pydantic_json_schema__(
        cls, schema: CoreSchema, handler: GetJsonSchemaHandler
    ) -> dict[str, Any]:
        from steering_plant.effects import EFFECTS

        entries = {name: _effect_entry(effect) for name, effect in EFFECTS.items()}
        return {"type": "object", "properties": entries, "additionalProperties": False}


def _effect_entry(effect: Any) -> dict[str, Any]:
    values = {
        name: {
            "type": "number",
            "description": effect.info[name],
            "minimum": p.low,
            "maximum": p.high,
        }
        for name, p in effect.parameters.items()
    }
    return {
        "type": ["object", "null"],
        "description": effect.summary,
        "properties": values,
        "additionalProperties": False,
    }


EffectValues = Annotated[dict[str, dict[str, float]], BeforeValidator(check_effects), EffectSchema]
