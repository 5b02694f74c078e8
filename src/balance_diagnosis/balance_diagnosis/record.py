"""A record: what was measured, channel by channel, on one grid of times."""

from __future__ import annotations

import csv
import hashlib
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np

from balance_diagnosis.errors import BalanceError

LEAST_SAMPLES = 50


class Record:
    """Channels of one experiment.

    times: (n,) [s], increasing. channels: name to (n,), NaN where nothing was measured or nothing
    is to be judged. units, noise: of channels, as far as known; noise is the standard deviation of
    one sample's own, white noise, in the channel's unit. A gap in ``times`` is none in the model:
    cut the record there, or bring it on one grid.
    """

    def __init__(
        self,
        times: np.ndarray,
        channels: Mapping[str, np.ndarray],
        units: Mapping[str, str] | None = None,
        noise: Mapping[str, float] | None = None,
        name: str = "record",
    ) -> None:
        self.name = name
        if not isinstance(channels, Mapping):
            raise BalanceError(
                f"record '{name}': channels is a {type(channels).__name__}; give {{'name': values}}"
            )
        self.times = self._numbers("times", times)
        self.channels = {key: self._numbers(key, value) for key, value in channels.items()}
        self.units = dict(units or {})
        self.noise = dict(noise or {})
        self._check()

    def __getitem__(self, channel: str) -> np.ndarray:
        if channel not in self.channels:
            raise BalanceError(
                f"record '{self.name}' has no channel '{channel}'; it has {self._listed()}"
            )
        return self.channels[channel]

    def __len__(self) -> int:
        return len(self.times)

    @property
    def period(self) -> float:
        """Median distance of samples [s]."""
        return float(np.median(np.diff(self.times)))

    def part(self, start: float, stop: float, name: str | None = None) -> Record:
        """Return the samples from one share of the record to another (0 to 1), as a record."""
        if not 0.0 <= start < stop <= 1.0:
            raise BalanceError(
                f"part({start:g}, {stop:g}): shares between 0 and 1, the lower first"
            )
        cut = slice(round(start * len(self)), round(stop * len(self)))
        named = name or f"{self.name} {start:.0%} to {stop:.0%}"
        channels = {key: value[cut] for key, value in self.channels.items()}
        return Record(self.times[cut], channels, self.units, self.noise, named)

    def replaced(self, channels: Mapping[str, np.ndarray], name: str | None = None) -> Record:
        """Return a record with some channels replaced or added."""
        return Record(
            self.times, {**self.channels, **channels}, self.units, self.noise, name or self.name
        )

    def rows(self) -> np.ndarray:
        """Return all channels side by side in the order of their names, (n, channels)."""
        return np.stack([self.channels[key] for key in sorted(self.channels)], axis=1)

    def digest(self) -> str:
        """Return a hash of names and numbers: equal for the same bytes."""
        made = hashlib.sha256("|".join(sorted(self.channels)).encode())
        made.update(np.ascontiguousarray(self.rows()).tobytes())
        return made.hexdigest()

    @classmethod
    def from_csv(
        cls,
        path: str | Path,
        time: str | float,
        channels: Mapping[str, str] | None = None,
        units: Mapping[str, str] | None = None,
        noise: Mapping[str, float] | None = None,
        name: str | None = None,
    ) -> Record:
        """Read a comma separated file with one header line.

        time: the column of times [s], or the period [s] of a file without one. channels: channel
        to column; all columns under their own names where not given. Empty cells are NaN.
        """
        path = Path(path)
        if not isinstance(time, str) and not time > 0.0:
            raise BalanceError(
                f"'{path}': time is a column's name or a period above zero, not {time}"
            )
        table = _table(path)
        wanted = channels or {c: c for c in table if c != time}
        times = (
            _column(table, time, path)
            if isinstance(time, str)
            else time * np.arange(len(next(iter(table.values()))))
        )
        found = {key: _column(table, column, path) for key, column in wanted.items()}
        return cls(times, found, units, noise, name or path.stem)

    def _numbers(self, what: str, values: Any) -> np.ndarray:
        try:
            return np.asarray(values, float)
        except (TypeError, ValueError) as error:
            raise BalanceError(f"record '{self.name}', '{what}': no numbers: {error}") from None

    def _check(self) -> None:
        if self.times.ndim != 1:
            raise BalanceError(
                f"record '{self.name}': times have shape {self.times.shape}, not (n,)"
            )
        n = len(self.times)
        if n < LEAST_SAMPLES:
            raise BalanceError(
                f"record '{self.name}' has {n} samples; {LEAST_SAMPLES} are the least"
            )
        if not np.all(np.isfinite(self.times)) or np.any(np.diff(self.times) <= 0.0):
            at = int(np.argmax(~(np.diff(self.times) > 0.0)))
            raise BalanceError(
                f"record '{self.name}': times have to increase; sample {at + 1} "
                f"({self.times[at + 1]:g} s) does not come after {self.times[at]:g} s"
            )
        if not self.channels:
            raise BalanceError(f"record '{self.name}' has no channels")
        for key, value in self.channels.items():
            if value.shape != (n,):
                raise BalanceError(
                    f"record '{self.name}', channel '{key}': shape {value.shape}, expected ({n},)"
                )
            if np.any(np.isinf(value)):
                at = int(np.argmax(np.isinf(value)))
                raise BalanceError(
                    f"record '{self.name}', channel '{key}': infinite at sample {at}"
                )
        for what, given in (("unit", self.units), ("noise", self.noise)):
            for key in given:
                if key not in self.channels:
                    raise BalanceError(
                        f"record '{self.name}': a {what} is given for '{key}', which is no channel;"
                        f" there are {self._listed()}"
                    )
        for key, noise in self.noise.items():
            if not isinstance(noise, int | float) or not noise >= 0.0:
                raise BalanceError(f"record '{self.name}': the noise of '{key}' is {noise}")

    def _listed(self) -> str:
        return ", ".join(f"'{key}'" for key in sorted(self.channels))


def _table(path: Path) -> dict[str, np.ndarray]:
    """Return the columns of a file. BalanceError names the line of what is no number."""
    try:
        with path.open(encoding="utf-8-sig", newline="") as opened:
            lines = [(number, row) for number, row in enumerate(csv.reader(opened), 1) if row]
    except FileNotFoundError:
        raise BalanceError(f"there is no file '{path}'") from None
    except (OSError, UnicodeDecodeError, csv.Error) as error:
        raise BalanceError(f"'{path}' cannot be read as comma separated text: {error}") from None
    if len(lines) < 2:
        raise BalanceError(f"'{path}' has no header line with names, or no lines below it")
    names = [cell.strip() for cell in lines[0][1]]
    other = next((sign for sign in (";", "\t", "|") if sign in lines[0][1][0]), None)
    if len(names) == 1 and other:
        raise BalanceError(
            f"'{path}' is separated by {other!r}, not by commas: save it with commas and decimal "
            "points, or read it otherwise and give Record(times, channels)"
        )
    twice = [name for name in names if names.count(name) > 1]
    if twice:
        raise BalanceError(f"'{path}' has the column '{twice[0]}' twice: rename one")
    values = np.full((len(lines) - 1, len(names)), np.nan)
    for at, (number, row) in enumerate(lines[1:]):
        if len(row) != len(names):
            raise BalanceError(
                f"'{path}', line {number}: {len(row)} cells, and the header has {len(names)} names"
            )
        for k, cell in enumerate(row):
            values[at, k] = _number(cell, f"'{path}', line {number}, column '{names[k]}'")
    return dict(zip(names, values.T.copy(), strict=True))


def _number(cell: str, where: str) -> float:
    if not cell.strip():
        return np.nan
    try:
        return float(cell)
    except ValueError:
        raise BalanceError(
            f"{where}: '{cell.strip()}' is no number; leave the cell empty where there is none"
        ) from None


def _column(table: Mapping[str, np.ndarray], column: str, path: Path) -> np.ndarray:
    if column not in table:
        raise BalanceError(f"'{path}' has no column '{column}'; it has {', '.join(table)}")
    return table[column]
