"""The extended model: the model with the numbers and the causes that a diagnosis found."""

from __future__ import annotations

import json
import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from balance_diagnosis.errors import BalanceError
from balance_diagnosis.intervals import Estimate
from balance_diagnosis.model import Model, Prediction
from balance_diagnosis.plain_yaml import to_text
from balance_diagnosis.record import Record

SCHEMA = 1


@dataclass(frozen=True)
class Extended:
    """A model with its numbers. values: of parameters and causes. starts: record to its starts."""

    model: Model
    values: Mapping[str, float]
    starts: Mapping[str, Mapping[str, float]]

    @classmethod
    def of(cls, model: Model, numbers: Sequence[Estimate]) -> Extended:
        """Return the model with the numbers that were found."""
        starts: dict[str, dict[str, float]] = {}
        for number in numbers:
            if number.record:
                starts.setdefault(number.record, {})[number.name] = float(number.value)
        return cls(model, {n.name: float(n.value) for n in numbers if not n.record}, starts)

    @classmethod
    def read(cls, model: Model, path: str | Path) -> Extended:
        """Read extended_model.yaml back for its model.

        An edited file may be any YAML if PyYAML is installed. BalanceError names the file and what
        does not fit the model.
        """
        data = _read(Path(path))
        told = data["parameters"], *data["causes"].values()
        values = {name: number for group in told for name, number in group.items()}
        _check(model, values, data["causes"], path)
        missing = [name for name in model.parameters if name not in values]
        if missing:
            raise BalanceError(f"'{path}' has no value of {_listed(missing)}")
        return cls(model, values, data["starts"])

    def predicted(self, record: Record, **starts: float) -> Prediction:
        """Return the prediction. starts: of a record of which they were not fitted."""
        known = {**self.starts.get(record.name, {}), **starts}
        unknown = [name for name in starts if name not in self.model.starts]
        if unknown:
            raise BalanceError(f"the model has no start {_listed(unknown)}")
        missing = [name for name in self.model.starts if name not in known]
        if missing:
            raise BalanceError(
                f"record '{record.name}' was not fitted: give its starts, as "
                f"predicted(record, {missing[0]}=...); it lacks {_listed(missing)}"
            )
        return self.model.predicted({**self.values, **known}, record)


def file_text(model: Model, numbers: Sequence[Estimate], title: str) -> str:
    """Return extended_model.yaml: parameters, causes and starts with their 95 % intervals."""
    data: dict[str, Any] = {"schema": SCHEMA, "model": title, "parameters": {}}
    causes: dict[str, Any] = {}
    starts: dict[str, Any] = {}
    for number in numbers:
        if number.record:
            group = starts.setdefault(number.record, {})
        elif number.cause:
            group = causes.setdefault(number.cause, {})
        else:
            group = data["parameters"]
        group[number.name] = {
            "value": number.value,
            "low": number.low,
            "high": number.high,
            "unit": model.units.get(number.name, ""),
        }
    return to_text({**data, "causes": causes, "starts": starts})


def _read(path: Path) -> dict[str, dict[str, Any]]:
    """Return the file's groups with plain numbers, {"parameters", "causes", "starts"}."""
    try:
        data = _parsed(path.read_text("utf-8"), path)
    except (OSError, UnicodeDecodeError) as error:
        raise BalanceError(f"'{path}' cannot be read: {error}") from None
    if not isinstance(data, dict) or data.get("schema") != SCHEMA:
        raise BalanceError(f"'{path}' is no extended model: it has no 'schema: {SCHEMA}'")
    found: dict[str, dict[str, Any]] = {"parameters": {}, "causes": {}, "starts": {}}
    for key, group in found.items():
        given = data.get(key) or {}
        if not isinstance(given, dict):
            raise BalanceError(f"'{path}': '{key}' has to hold names with their values")
        for name, entry in given.items():
            if key == "parameters":
                group[name] = _value(entry, name, path)
            elif isinstance(entry, dict):
                group[name] = {n: _value(v, n, path) for n, v in entry.items()}
            else:
                raise BalanceError(f"'{path}': '{name}' of '{key}' has to hold names and values")
    return found


def _parsed(text: str, path: Path) -> Any:
    try:
        return json.loads(text)
    except ValueError as error:
        try:
            import yaml
        except ModuleNotFoundError:
            raise BalanceError(
                f"'{path}' is not as it was written ({error}); reading other YAML needs "
                "'pip install PyYAML'"
            ) from None
        try:
            return yaml.safe_load(text)
        except yaml.YAMLError as fault:
            raise BalanceError(f"'{path}' is no YAML: {' '.join(str(fault).split())}") from None


def _value(entry: Any, name: str, path: Path) -> float:
    value = entry.get("value") if isinstance(entry, dict) else entry
    if isinstance(value, bool) or not isinstance(value, int | float) or not math.isfinite(value):
        raise BalanceError(f"'{path}': '{name}' has no number as its value, but {value!r}")
    return float(value)


def _check(
    model: Model, values: Mapping[str, float], causes: Mapping[str, Any], path: str | Path
) -> None:
    for cause in causes:
        if cause not in model.causes:
            raise BalanceError(f"'{path}': the model has no cause '{cause}'")
    known = {*model.parameters, *model.off()}
    unknown = [name for name in values if name not in known]
    if unknown:
        raise BalanceError(f"'{path}': the model has no {_listed(unknown)}")


def _listed(names: Sequence[str]) -> str:
    return ", ".join(f"'{name}'" for name in names)
