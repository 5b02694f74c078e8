"""``--set NAME=VALUE`` of the studies' commands: parameters of the data sheet."""

from __future__ import annotations

from collections.abc import Iterable

from steering_bringup.errors import BenchError
from steering_core.parameters import ParameterError, load_parameters


def parameters_of(texts: Iterable[str]) -> dict[str, float]:
    """Return full name to value [SI]; BenchError names what cannot be, and the nearest name."""
    values: dict[str, float] = {}
    sheet = load_parameters()
    for text in texts:
        name, sign, value = (part.strip() for part in text.partition("="))
        if not sign or not value:
            raise BenchError(f"--set {text}: write NAME=VALUE, such as mechanics.rack_mass=30")
        try:
            values[name] = sheet.info(name).checked(name, value)
        except ParameterError as error:
            raise BenchError(f"--set {text}: {error}") from None
    return values
