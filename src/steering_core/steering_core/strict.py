"""The base of all schema models: no unknown key, no number that is none."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from typing import Annotated, Any

from pydantic import BaseModel, BeforeValidator, ConfigDict, model_validator
from pydantic_core import PydanticCustomError

from steering_core.naming import unknown


def fault(key: str | tuple[str, ...], text: str) -> PydanticCustomError:
    """Return an error about an entry of the mapping that is being checked: its key, or the way."""
    return PydanticCustomError("fault", "{text}", {"key": key, "text": text})


class Strict(BaseModel):
    """Keys must be known (the nearest is named), numbers finite; objects are immutable."""

    model_config = ConfigDict(extra="forbid", frozen=True, allow_inf_nan=False)

    @model_validator(mode="before")
    @classmethod
    def _known_keys(cls, data: Any) -> Any:
        if isinstance(data, Mapping):
            check_keys("key", data, (f.alias or n for n, f in cls.model_fields.items()))
        return data


def check_keys(
    what: str, data: Mapping[Any, Any], known: Iterable[str], within: tuple[str, ...] = ()
) -> None:
    """Raise an error naming the first key of ``data`` that is not ``known``, and the nearest.

    within: the way to ``data`` from the mapping that is being checked.
    """
    names = list(known)
    for key in data:
        if key not in names:
            raise fault((*within, str(key)), unknown(what, str(key), names))


def number(value: Any) -> Any:
    """Let numbers through, and texts of numbers (YAML reads 1e-3 as a text); no true or false."""
    if isinstance(value, bool):
        raise ValueError(f"must be a number, got {str(value).lower()}")
    if isinstance(value, str):
        try:
            return float(value)
        except ValueError:
            raise ValueError(f"must be a number, got '{value}'") from None
    return value


Number = Annotated[float, BeforeValidator(number)]
