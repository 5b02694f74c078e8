"""The YAML that binds an FMU: what its variables are in the diagnosis."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from difflib import get_close_matches
from pathlib import Path
from typing import Any

from balance_diagnosis.errors import BalanceError
from balance_diagnosis.fmu.optional import needed
from balance_diagnosis.priors import Prior, between, toleranced

SCHEMA = 1

SENSOR = ("offset_of", "gain_of", "delay_of")
"""Causes that need nothing in the FMU: y + size, y (1 + size), y a time of size [s] before."""

KEYS = (
    *("schema", "name", "parameters", "starts", "causes", "inputs", "outputs", "states"),
    *("held", "steps", "data"),
)
PRIOR_KEYS = ("variable", "nominal", "tolerance", "plus_minus", "low", "high", "between", "unit")
NUMBER_KEYS = ("variable", "neutral", "low", "high", "unit", *SENSOR)


@dataclass(frozen=True)
class Sensor:
    """What a number of a cause does to a channel. kind: one of ``SENSOR``."""

    kind: str
    channel: str


@dataclass(frozen=True)
class Binding:
    """The file, checked in itself.

    variables: number to the FMU's variable. sensors: number to what it does to a channel instead.
    inputs, outputs: channel to variable. states: variables that help to describe what is left.
    held: inputs keep their value from sample to sample, in place of their mean of both. steps: of
    the FMU from sample to sample. data: left to whoever reads the records.
    """

    name: str
    parameters: dict[str, Prior]
    starts: dict[str, Prior]
    causes: dict[str, dict[str, tuple[float, float, float]]]
    variables: dict[str, str]
    sensors: dict[str, Sensor]
    units: dict[str, str]
    inputs: dict[str, str]
    outputs: dict[str, str]
    states: tuple[str, ...]
    held: bool
    steps: int
    data: dict[str, Any]


def read_binding(path: Path) -> Binding:
    """Read the YAML; BalanceError names the file, the key and what is wrong."""
    yaml = needed("yaml")
    try:
        given = yaml.safe_load(path.read_text("utf-8"))
    except (OSError, UnicodeDecodeError) as error:
        raise BalanceError(f"'{path}' cannot be read: {error}") from None
    except yaml.YAMLError as error:
        raise BalanceError(f"'{path}' is no YAML: {' '.join(str(error).split())}") from None
    try:
        return _binding(given, path.stem)
    except BalanceError as error:
        raise BalanceError(f"'{path}': {error}") from None


def _binding(given: Any, name: str) -> Binding:
    given = _keys(given, KEYS, "the file")
    if given.get("schema") != SCHEMA:
        raise BalanceError(f"'schema: {SCHEMA}' is missing")
    variables: dict[str, str] = {}
    sensors: dict[str, Sensor] = {}
    units: dict[str, str] = {}
    priors: dict[str, dict[str, Prior]] = {"parameters": {}, "starts": {}}
    for group, found in priors.items():
        for key, entry in _group(given, group).items():
            where = f"{group}, '{key}'"
            entry = _keys(entry, PRIOR_KEYS, where)
            found[key] = _prior(entry, where)
            variables[key] = str(entry.get("variable", key))
            units[key] = str(entry.get("unit", ""))
    causes: dict[str, dict[str, tuple[float, float, float]]] = {}
    for cause, numbers in _group(given, "causes").items():
        causes[cause] = {}
        for key, entry in _named(numbers, f"cause '{cause}'").items():
            where = f"cause '{cause}', '{key}'"
            entry = _keys(entry, NUMBER_KEYS, where)
            causes[cause][key] = tuple(_number(entry, k, where) for k in ("neutral", "low", "high"))  # type: ignore[assignment]
            units[key] = str(entry.get("unit", ""))
            sensor = [kind for kind in SENSOR if kind in entry]
            if len(sensor) + ("variable" in entry) > 1:
                raise BalanceError(f"{where}: give one of variable, {', '.join(SENSOR)}")
            if sensor:
                sensors[key] = Sensor(sensor[0], str(entry[sensor[0]]))
                _is_off(sensors[key], causes[cause][key][0], where)
            else:
                variables[key] = str(entry.get("variable", key))
    inputs, outputs = (_texts(given, key) for key in ("inputs", "outputs"))
    if not outputs:
        raise BalanceError("'outputs' is missing: name the channels that the FMU predicts")
    for key, sensor_ in sensors.items():
        if sensor_.channel not in {**inputs, **outputs}:
            raise BalanceError(f"'{key}': '{sensor_.channel}' is no channel of inputs or outputs")
    return Binding(
        str(given.get("name", name)),
        priors["parameters"],
        priors["starts"],
        causes,
        variables,
        sensors,
        {key: unit for key, unit in units.items() if unit},
        inputs,
        outputs,
        tuple(str(s) for s in given.get("states") or ()),
        given.get("held") is True,
        _steps(given.get("steps", 1)),
        _named(given.get("data") or {}, "data"),
    )


def unknown(name: str, known: Iterable[str], what: str) -> str:
    """Return the line about a name that is none, with the nearest that is."""
    names = list(known)
    near = get_close_matches(name, names, n=1, cutoff=0.5)
    listed = ", ".join(f"'{n}'" for n in names[:20]) + (", ..." if len(names) > 20 else "")
    hint = f"did you mean '{near[0]}'?" if near else f"there are {listed or 'none'}"
    return f"there is no {what} '{name}'; {hint}"


def _prior(entry: Mapping[str, Any], where: str) -> Prior:
    try:
        if "between" in entry:
            low, high = (float(v) for v in entry["between"])
            return between(low, high)
        ends = {key: _number(entry, key, where) for key in ("low", "high") if key in entry}
        if "nominal" not in entry:
            raise BalanceError("give 'between: [low, high]', or 'nominal' with a 'tolerance'")
        wide = {key: _number(entry, key, where) for key in ("plus_minus",) if key in entry}
        share = _number(entry, "tolerance", where) if "tolerance" in entry else None
        return toleranced(_number(entry, "nominal", where), share, **wide, **ends)
    except (TypeError, ValueError):
        raise BalanceError(f"{where}: 'between' holds two numbers") from None
    except BalanceError as error:
        text = str(error)
        raise BalanceError(text if text.startswith(where) else f"{where}: {text}") from None


def _is_off(sensor: Sensor, off: float, where: str) -> None:
    if off != 0.0:
        raise BalanceError(f"{where}: {sensor.kind} does nothing at 0, so 'neutral' has to be 0")


def _keys(given: Any, known: tuple[str, ...], where: str) -> dict[str, Any]:
    entries = _named(given, where)
    for key in entries:
        if key not in known:
            raise BalanceError(f"{where}: {unknown(key, known, 'key')}")
    return entries


def _named(given: Any, where: str) -> dict[str, Any]:
    if not isinstance(given, dict):
        raise BalanceError(f"{where} has to hold names with their values, not {given!r}")
    return {str(key): value for key, value in given.items()}


def _group(given: Mapping[str, Any], key: str) -> dict[str, Any]:
    return _named(given.get(key) or {}, f"'{key}'")


def _texts(given: Mapping[str, Any], key: str) -> dict[str, str]:
    return {channel: str(variable) for channel, variable in _group(given, key).items()}


def _number(entry: Mapping[str, Any], key: str, where: str) -> float:
    value = entry.get(key)
    if isinstance(value, bool) or not isinstance(value, int | float):
        hint = " (YAML reads 1e-3 as a text: write 1.0e-3)" if isinstance(value, str) else ""
        raise BalanceError(f"{where}: '{key}' has to be a number, not {value!r}{hint}")
    return float(value)


def _steps(value: Any) -> int:
    if isinstance(value, bool) or not isinstance(value, int) or value < 1:
        raise BalanceError(f"'steps' has to be a whole number from 1, not {value!r}")
    return value
