"""A model bound to records: from coordinates in standard deviations to rows of residuals."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from balance_diagnosis.constants import LEAST_ROWS, ROWS, Constants
from balance_diagnosis.errors import BalanceError
from balance_diagnosis.model import Model, Prediction
from balance_diagnosis.priors import Prior, between
from balance_diagnosis.probing import Change, NothingError, Probed, probe
from balance_diagnosis.record import Record
from balance_diagnosis.rows import Series, series

HUGE = 1e150
"""What squares of residuals may not overflow."""

LEAST_JUDGED = 50

NOTHING: Mapping[str, float] = {}


@dataclass(frozen=True)
class Slot:
    """One coordinate. record: number of the only record that it acts on. cause: whose it is."""

    name: str
    prior: Prior
    record: int | None = None
    cause: str = ""


class Problem:
    """Residuals of a model on records, and their rows.

    Before ``reduce`` rows are a coarse average; after it they are the band of the nominal error.
    ``failures`` counts evaluations that raised or were not finite.
    """

    def __init__(self, model: Model, records: Sequence[Record], constants: Constants) -> None:
        self.model, self.records, self.constants = model, tuple(records), constants
        self.failures: dict[str, int] = {}
        self.calls = 0
        self.probed: dict[str, Probed] = {}
        self.common = [Slot(name, prior) for name, prior in model.parameters.items()]
        first = [self._first(record) for record in self.records]
        self.outputs = tuple(dict.fromkeys(key for made in first for key in made.outputs))
        self.common += [
            Slot(name, prior or _start(name, record, next(iter(made.outputs))), number)
            for number, (record, made) in enumerate(zip(self.records, first, strict=True))
            for name, prior in model.starts.items()
        ]
        self.scale = {
            (number, key): _deviation([r for r in self.records if key in r.channels], key)
            for number, made in enumerate(first)
            for key in made.outputs
        }
        each = max(ROWS // len(self.scale), LEAST_ROWS)
        self.rows = [
            Series(number, key, -(-len(record) // each), np.isfinite(record[key]))
            for (number, key), record in ((at, self.records[at[0]]) for at in self.scale)
        ]

    # --- rows

    @property
    def rows(self) -> list[Series]:
        """The series in the order of the rows."""
        return self._rows

    @rows.setter
    def rows(self, rows: list[Series]) -> None:
        self._rows = rows
        sizes = [len(s) for s in rows]
        ends = np.cumsum([0, *sizes])
        self.spans = [slice(a, b) for a, b in pairwise(ends)]
        self.output_of = np.repeat([self.outputs.index(s.output) for s in rows], sizes)
        self.count = int(ends[-1])

    def reduce(self, names: Sequence[str], x: np.ndarray) -> None:
        """Choose the rows anew, for the error that a model leaves."""
        share, made = self.constants.band, []
        most = max(ROWS // len(self.scale), LEAST_ROWS)
        for number, record in enumerate(self.records):
            predicted = self.predicted(number, self.values(names, x, number))
            for key, output in predicted.outputs.items():
                made.append(series(number, key, record[key] - output, share, most, LEAST_ROWS))
        self.rows = made

    def learn(self, x: np.ndarray) -> None:
        """Find out what every cause does, about the nominal model at x.

        What does nothing there, where the fit has led the states past it, is tried about the
        priors' middle too.
        """
        about = [self._change(place) for place in (x, np.zeros(len(x)))]
        for name, cause in self.model.causes.items():
            try:
                self.probed[name] = probe(cause, about[0], self.constants)
            except NothingError:
                self.probed[name] = probe(cause, about[1], self.constants)

    def _change(self, x: np.ndarray) -> Change:
        """Return the function that tells what a cause's numbers change about the model at x."""
        base = [self.values((), x, number) for number in range(len(self.records))]
        off = [self.attempt(number, values) for number, values in enumerate(base)]

        def change(numbers: Mapping[str, float]) -> np.ndarray | None:
            """Return what numbers change in all outputs, over the outputs' deviations."""
            parts = []
            for number, values in enumerate(base):
                made, before = self.attempt(number, {**values, **numbers}), off[number]
                if made is None or before is None:
                    return None
                for key, plain in before.outputs.items():
                    valid = np.isfinite(self.records[number][key])
                    moved = np.where(valid, made.outputs[key] - plain, 0.0)
                    parts.append(
                        moved / (self.scale[number, key] * np.sqrt(valid.sum() * len(base)))
                    )
            return np.concatenate(parts)

        return change

    # --- coordinates

    def slots(self, names: Sequence[str]) -> list[Slot]:
        """Return the coordinates of a model with the named causes."""
        added = [
            Slot(key, prior, None, name)
            for name in names
            for key, prior in self.probed[name].priors.items()
        ]
        return [*self.common, *added]

    def values(self, names: Sequence[str], x: np.ndarray, record: int) -> dict[str, float]:
        """Return the numbers that coordinates mean, for one record."""
        return {
            slot.name: slot.prior.value(float(place))
            for slot, place in zip(self.slots(names), x, strict=True)
            if slot.record is None or slot.record == record
        }

    # --- evaluation

    def predicted(self, number: int, values: Mapping[str, float]) -> Prediction:
        """Return the prediction of a record; BalanceError where the model is used wrongly."""
        self.calls += 1
        return self.model.predicted(values, self.records[number])

    def attempt(self, number: int, values: Mapping[str, float]) -> Prediction | None:
        """Return the prediction, or None where the model fails there; the reason is counted."""
        try:
            made = self.predicted(number, values)
        except Exception as error:
            self._failed(f"{type(error).__name__}: {' '.join(str(error).split())}")
            return None
        if not all(np.all(np.isfinite(output)) for output in made.outputs.values()):
            self._failed("its prediction is not finite")
            return None
        return made

    def _failed(self, why: str) -> None:
        self.failures[why] = self.failures.get(why, 0) + 1

    def part(self, number: int, values: Mapping[str, float]) -> list[np.ndarray] | None:
        """Return the rows of the residuals of one record, by series; None where it fails."""
        made = self.attempt(number, values)
        if made is None:
            return None
        record = self.records[number]
        found = [
            s.means(record[s.output] - made.outputs[s.output])
            for s in self.rows
            if s.record == number
        ]
        return found if all(np.abs(r).max(initial=0.0) < HUGE for r in found) else None

    def residual(
        self, names: Sequence[str], x: np.ndarray, added: Mapping[str, float] = NOTHING
    ) -> np.ndarray | None:
        """Return measured minus predicted, (rows,). added: numbers beside the coordinates."""
        found: list[np.ndarray] = []
        for number in range(len(self.records)):
            part = self.part(number, {**self.values(names, x, number), **added})
            if part is None:
                return None
            found += part
        return np.concatenate(found)

    def _first(self, record: Record) -> Prediction:
        """Return the prediction at the nominal values; BalanceError where there is none."""
        starts = {name: (prior or between(-1.0, 1.0)) for name, prior in self.model.starts.items()}
        centre = {name: prior.nominal for name, prior in self.model.parameters.items()}
        try:
            if starts:
                made = self.model.predicted(
                    {**centre, **{name: prior.nominal for name, prior in starts.items()}}, record
                )
                first = next(iter(made.outputs))
                for name, prior in self.model.starts.items():
                    starts[name] = prior or _start(name, record, first)
            values = {**centre, **{name: prior.nominal for name, prior in starts.items()}}
            made = self.model.predicted(values, record)
        except BalanceError:
            raise
        except Exception as error:
            text = " ".join(str(error).split())
            raise BalanceError(
                f"the model fails at its nominal values on record '{record.name}': "
                f"{type(error).__name__}: {text}"
            ) from error
        for key, output in made.outputs.items():
            if not np.all(np.isfinite(output)):
                at = int(np.argmax(~np.isfinite(output)))
                gaps = [c for c in record.channels if np.isnan(record[c][: at + 1]).any()]
                gaps = [c for c in gaps if c not in made.outputs]
                why = f": channel '{gaps[0]}', which it reads, has a gap there" if gaps else ""
                raise BalanceError(
                    f"the model's '{key}' is {output[at]} at sample {at} of record '{record.name}',"
                    f" at its nominal values{why}"
                )
        return made


def _deviation(records: Sequence[Record], channel: str) -> float:
    """Return the standard deviation of a channel over its records, of a constant one its size."""
    for record in records:
        judged = int(np.isfinite(record[channel]).sum())
        if judged < LEAST_JUDGED:
            raise BalanceError(
                f"record '{record.name}', channel '{channel}': {judged} samples are judged; "
                f"{LEAST_JUDGED} are the least"
            )
    values = np.concatenate([record[channel] for record in records])
    values = values[np.isfinite(values)]
    return max(float(values.std()), 1e-6 * float(np.abs(values).max())) or 1.0


def _start(name: str, record: Record, output: str) -> Prior:
    """Return the prior of a start of which nothing is told."""
    channel = name if name in record.channels else output
    judged = record[channel][np.isfinite(record[channel])]
    width = 2.0 * max(float(np.ptp(judged)), 1e-9 * float(np.abs(judged).max()), 1e-12)
    middle = (
        float(judged[0]) if name in record.channels else 0.5 * float(judged.max() + judged.min())
    )
    return Prior(middle, 0.5 * width, middle - width, middle + width)
