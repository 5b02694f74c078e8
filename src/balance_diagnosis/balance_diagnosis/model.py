"""A model under diagnosis: a prediction, what is known of its numbers, and what may be wrong."""

from __future__ import annotations

import keyword
from collections.abc import Callable, Mapping, Sequence
from copy import copy
from dataclasses import dataclass
from typing import Any

import numpy as np

from balance_diagnosis.errors import BalanceError
from balance_diagnosis.priors import Prior
from balance_diagnosis.record import Record

Predict = Callable[..., Any]


class Values(dict[str, float]):
    """Numbers by name, as ``p["mass"]`` or ``p.mass``."""

    def __getattr__(self, name: str) -> float:
        try:
            return self[name]
        except BalanceError as error:
            raise AttributeError(str(error)) from None

    def __missing__(self, name: str) -> float:
        raise BalanceError(
            f"there is no '{name}' among the model's numbers; there are {_listed(self)}"
        )


@dataclass(frozen=True)
class Number:
    """A number of a cause: off, where it does nothing, and its bounds."""

    name: str
    off: float
    low: float
    high: float


@dataclass(frozen=True)
class Cause:
    """Something that may be wrong: it is off while all its numbers are."""

    name: str
    numbers: tuple[Number, ...]


@dataclass(frozen=True)
class Prediction:
    """outputs: channel to (n,). states: whatever else the model tells of itself, name to (n,)."""

    outputs: dict[str, np.ndarray]
    states: dict[str, np.ndarray]


class Model:
    """A prediction with its parameters, starts and causes.

    predict(p, record) returns the predicted channels, name to (n,); of one output also the array
    alone, if ``outputs`` names it. p has every number by name. What it returns under other names
    than the record's channels are states, which help to describe what is left. It has to be
    deterministic. parameters: name to ``between(low, high)`` or ``toleranced(nominal, share)``.
    starts: unknown numbers of each record anew, by name (within twice the range of the first
    output, about the first value where a channel has that name) or with a prior of their own.
    causes: name to number to (off, low, high). units: of any of these numbers, and name: of the
    machine, both for the report.
    """

    def __init__(
        self,
        predict: Predict,
        parameters: Mapping[str, Prior],
        causes: Mapping[str, Mapping[str, Sequence[float]]],
        starts: Sequence[str] | Mapping[str, Prior] = (),
        outputs: Sequence[str] = (),
        units: Mapping[str, str] | None = None,
        name: str = "model",
    ) -> None:
        self.predict = predict
        self.units, self.name = dict(units or {}), name
        self.parameters = dict(_named(parameters, "parameters", "between(0.5, 2.0)"))
        self.starts: dict[str, Prior | None] = (
            dict(starts)
            if isinstance(starts, Mapping)
            else dict.fromkeys((starts,) if isinstance(starts, str) else starts)
        )
        self.outputs = (outputs,) if isinstance(outputs, str) else tuple(outputs)
        catalogue = _named(causes, "causes", "{'size': (off, low, high)}")
        self.causes = {name: _cause(name, numbers) for name, numbers in catalogue.items()}
        self._off = {n.name: n.off for cause in self.causes.values() for n in cause.numbers}
        self._check()

    def without(self, *names: str) -> Model:
        """Return the model with some causes taken out of its catalogue."""
        for name in names:
            if name not in self.causes:
                raise BalanceError(f"there is no cause '{name}' to take out")
        lean = copy(self)
        lean.causes = {key: cause for key, cause in self.causes.items() if key not in names}
        if not lean.causes:
            raise BalanceError("no cause would be left in the catalogue")
        return lean

    def off(self) -> dict[str, float]:
        """Return every number of every cause at its off value, those taken out included."""
        return dict(self._off)

    def predicted(self, values: Mapping[str, float], record: Record) -> Prediction:
        """Return the prediction for all numbers; causes that are not given are off.

        BalanceError where what ``predict`` returns has the wrong kind, name or shape.
        """
        p = Values({**self._off, **values})
        with np.errstate(all="ignore"):
            made = self.predict(p, record)
        if not isinstance(made, Mapping):
            if len(self.outputs) != 1:
                raise BalanceError(
                    "predict has to return its channels by name, as {'level': values}; "
                    f"it returned {type(made).__name__}"
                )
            made = {self.outputs[0]: made}
        arrays = {str(key): self._array(str(key), value, record) for key, value in made.items()}
        wanted = self.outputs or tuple(key for key in arrays if key in record.channels)
        if not wanted or any(key not in arrays for key in wanted):
            missing = [key for key in wanted if key not in arrays] or list(record.channels)
            raise BalanceError(
                f"predict returned {_listed(arrays)}, but no prediction of {_listed(missing)} "
                f"of record '{record.name}'"
            )
        outputs = {key: arrays.pop(key) for key in wanted}
        for key in outputs:
            record[key]
        return Prediction(outputs, arrays)

    def _array(self, key: str, value: Any, record: Record) -> np.ndarray:
        if np.iscomplexobj(value):
            raise BalanceError(f"predict returned '{key}' with complex numbers: return real ones")
        array = np.asarray(value, float)
        if array.shape != (len(record),):
            raise BalanceError(
                f"predict returned '{key}' with shape {array.shape}; "
                f"record '{record.name}' has {len(record)} samples"
            )
        return array

    def _check(self) -> None:
        if not callable(self.predict):
            raise BalanceError("predict has to be a function of (p, record)")
        if not self.causes:
            raise BalanceError("the model has no causes: there is nothing that could be named")
        owners: dict[str, str] = {}
        groups = {"the parameters": list(self.parameters), "the starts": list(self.starts)}
        groups |= {f"cause '{c.name}'": [n.name for n in c.numbers] for c in self.causes.values()}
        for owner, names in groups.items():
            for name in names:
                if not isinstance(name, str) or not name.isidentifier() or keyword.iskeyword(name):
                    raise BalanceError(f"'{name}' of {owner} is no name that p.NAME could have")
                if name in owners:
                    raise BalanceError(f"'{name}' is in {owners[name]} and in {owner}: rename one")
                owners[name] = owner
        for name in self.units:
            if name not in owners:
                raise BalanceError(f"a unit is given for '{name}', which is no number of the model")
        for name, prior in {**self.parameters, **self.starts}.items():
            if prior is not None and not isinstance(prior, Prior):
                raise BalanceError(
                    f"parameter '{name}': give between(low, high) or toleranced(nominal, share), "
                    f"not {prior!r}"
                )


def _named(given: Any, what: str, entry: str) -> Mapping[str, Any]:
    """Return what has names; BalanceError for a list or the like."""
    if not isinstance(given, Mapping):
        kind = type(given).__name__
        raise BalanceError(
            f"{what} is a {kind}; give names with what they hold: {{'name': {entry}}}"
        )
    return given


def _cause(name: str, numbers: Mapping[str, Sequence[float]]) -> Cause:
    if not isinstance(numbers, Mapping) or not numbers:
        raise BalanceError(f"cause '{name}' has no numbers; give {{'size': (off, low, high)}}")
    made = []
    for key, given in numbers.items():
        try:
            off, low, high = (float(v) for v in given)
        except (TypeError, ValueError):
            raise BalanceError(
                f"cause '{name}', '{key}': give (off, low, high), not {given!r}"
            ) from None
        if not all(np.isfinite((off, low, high))) or not low < high:
            raise BalanceError(f"cause '{name}', '{key}': no bounds: {low:g} to {high:g}")
        if not low <= off <= high:
            raise BalanceError(
                f"cause '{name}', '{key}': the bounds {low:g} to {high:g} exclude {off:g}, "
                "where it is off"
            )
        made.append(Number(key, off, low, high))
    return Cause(name, tuple(made))


def _listed(names: Any) -> str:
    return ", ".join(f"'{name}'" for name in names) or "nothing"
