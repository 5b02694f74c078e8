"""Records of any machine from the files that the bench reads: channels by names of its own."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from pathlib import Path
from typing import Literal

import numpy as np
from pydantic import ValidationError, model_validator

from balance_diagnosis import Record
from steering_core.errors import BenchError
from steering_core.strict import fault
from steering_core.validation import explain
from steering_core.yaml_lines import Document, read_yaml
from steering_diagnosis.data import mapping as gear
from steering_diagnosis.data.foreign import READERS, Raw, read_foreign
from steering_diagnosis.data.plausible import without
from steering_diagnosis.data.read import instants
from steering_diagnosis.data.resample import GAP_PERIODS, ROUNDING_S, Sampled, sampled
from steering_diagnosis.data.units import FACTORS, spelled

SECTION = "data"
"""Key of the model's YAML that holds the mapping of the file."""

GEAR_ONLY = ("valve_system", "parameter_set", "parameters", "boost_curve", "clocks")


class AnyMapping(gear.Mapping):
    """Where the channels of any machine are in a file. Values keep the unit that they have."""

    valve_system: Literal["open_centre", "closed_centre", "servo_valve"] = "open_centre"

    @model_validator(mode="after")
    def _fits(self) -> AnyMapping:
        for key in GEAR_ONLY:
            if key in self.model_fields_set:
                raise fault(key, f"{key} belongs to a steering gear: this is a model of its own")
        if spelled(self.time_unit) not in FACTORS["s"]:
            raise fault("time_unit", f"time_unit must be one of {', '.join(FACTORS['s'])}")
        if self.decimal is not None and self.decimal == self.thousands:
            raise fault("thousands", "decimal and thousands must differ")
        for name, channel in self.channels.items():
            if channel.clock:
                raise fault(("channels", name), f"{name}: there is one clock only")
        return self


def load_any_mapping(path: Path, channels: Iterable[str]) -> AnyMapping:
    """Return the section ``data`` of a model's YAML; BenchError names line and key.

    channels: that the model reads and predicts; each needs an entry.
    """
    document = read_yaml(path)
    section = document.data.get(SECTION) if isinstance(document.data, dict) else None
    if not isinstance(section, dict):
        raise BenchError(f"{path}: '{SECTION}' is missing: where the channels are in the file")
    origins = {place[1:]: at for place, at in document.origins.items() if place[:1] == (SECTION,)}
    try:
        mapping = AnyMapping.model_validate(section)
    except ValidationError as error:
        raise BenchError(explain(error, Document(str(path), section, origins))) from None
    for name in channels:
        if name not in mapping.channels:
            raise BenchError(f"{path}: '{SECTION}: channels' lacks the model's channel '{name}'")
    if mapping.database:
        beside = str(path.parent / mapping.database)
        mapping = mapping.model_copy(update={"database": beside})
    return mapping


def read_any(
    path: Path, mapping: AnyMapping, start: float | None = None, stop: float | None = None
) -> tuple[Record, list[str]]:
    """Return a record from ``start`` to ``stop`` [s from its beginning], and what is to be said.

    All channels are brought on the instants of the slowest one, linearly between samples, and not
    across gaps. BenchError names the file.
    """
    if path.suffix.lower() not in READERS:
        raise BenchError(f"'{path}': a model of its own takes files of {', '.join(READERS)}")
    raw = read_foreign(path, mapping)
    notes = [*dict.fromkeys(note for each in raw.values() for note in each.about)]
    try:
        channels = {name: _channel(name, raw[name], mapping, path, notes) for name in raw}
        times = _grid(channels, start, stop)
    except BenchError as error:
        text = str(error)
        raise BenchError(text if str(path) in text else f"'{path}': {text}") from None
    for channel in channels.values():
        notes += channel.findings
    values = {name: _at(channel, times) for name, channel in channels.items()}
    units = {name: mapping.channels[name].unit or raw[name].unit for name in channels}
    return Record(
        times - times[0], values, {n: u for n, u in units.items() if u}, name=path.stem
    ), notes


def _channel(name: str, raw: Raw, mapping: AnyMapping, path: Path, notes: list[str]) -> Sampled:
    mapped = mapping.channels[name]
    notes += [f"{name}: {note}" for note in raw.notes]
    given = without(raw.values, mapping.missing)
    values = mapped.sign * (mapped.scale * given + mapped.offset)
    time = instants(raw, mapping, path, notes) - mapped.delay
    return sampled(name, time, values, raw.lost, raw.lines)


def _grid(channels: Mapping[str, Sampled], start: float | None, stop: float | None) -> np.ndarray:
    """Return the instants of the slowest channel within what all share and what is asked for."""
    first = max(channel.time[0] for channel in channels.values())
    last = min(channel.time[-1] for channel in channels.values())
    slowest = max(channels.values(), key=lambda channel: channel.period)
    low = first + (start or 0.0)
    high = last if stop is None else min(last, first + stop)
    times = slowest.time[(slowest.time >= low) & (slowest.time <= high)]
    if len(times) < 2:
        raise BenchError(
            f"the channels share {max(last - first, 0.0):.4g} s; nothing is left from "
            f"{start or 0.0:g} s to {'the end' if stop is None else f'{stop:g} s'}"
        )
    return times


def _at(channel: Sampled, times: np.ndarray) -> np.ndarray:
    """Return a channel at some instants, (n,); NaN in its gaps."""
    after = np.clip(np.searchsorted(channel.time, times), 1, len(channel.time) - 1)
    width = channel.time[after] - channel.time[after - 1]
    nearest = np.minimum(
        np.abs(times - channel.time[after]), np.abs(times - channel.time[after - 1])
    )
    in_gap = (width > GAP_PERIODS * channel.period) & (nearest > ROUNDING_S)
    return np.where(in_gap, np.nan, np.interp(times, channel.time, channel.values))
