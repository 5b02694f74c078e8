"""Any measured data as a record: a bag, or a file of another tool with its mapping."""

from __future__ import annotations

import hashlib
import math
from itertools import combinations
from pathlib import Path

import numpy as np

from steering_core.errors import BenchError
from steering_core.parameters import ParameterError, ParameterSet, load_parameters
from steering_diagnosis.data import clocks
from steering_diagnosis.data.channels import CHANNELS, MEASURED
from steering_diagnosis.data.foreign import READERS, Raw, read_foreign
from steering_diagnosis.data.mapping import MappedChannel, Mapping, load_mapping
from steering_diagnosis.data.plausible import measured, without
from steering_diagnosis.data.record import PERIOD_S, READ_AS, Record
from steering_diagnosis.data.resample import Sampled, on_grid, sampled
from steering_diagnosis.data.ticks import in_ticks
from steering_diagnosis.data.units import FACTORS, factor, same, spelled
from steering_plant.measured_boost_curve import boost_table, read_boost_curve

SHORTEST_S = 2.0

LONGEST_S = 6.0 * 3600.0
"""Of what channels share: more needs gigabytes on ticks of 1 ms; a wrong instant makes years."""

SHORTEST_STEP_S, LONGEST_STEP_S = 2e-6, 0.1
"""Between samples. A steering gear is recorded neither at 500 kHz nor at 10 Hz: a time in ms that
is taken for s has steps of 1 s at 1 kHz, and one in s that is taken for ms has 1 us."""


def read_record(path: str | Path, mapping: str | Path | None = None) -> Record:
    """Return the record of a bag (folder or file), or of a file with its ``mapping``.

    Raises BenchError: no such file, no channel of the bench in it, too short, unreadable.
    """
    path = Path(path)
    if mapping is None:
        if path.suffix.lower() in READERS:
            raise BenchError(f"'{path}' needs a mapping file: --mapping FILE (docs/diagnosis.md)")
        from steering_diagnosis.data.bag import record_from_bag

        return record_from_bag(path)
    return record_from_file(path, Path(mapping))


def record_from_file(path: Path, mapping_path: Path) -> Record:
    """Return the record of a CSV, MATLAB or MDF4 file."""
    mapping, _ = load_mapping(mapping_path)
    raw = read_foreign(path, mapping)
    ways = dict.fromkeys(f"{READ_AS}{each.read_as}" for each in raw.values() if each.read_as)
    notes = [*ways, *dict.fromkeys(note for channel in raw.values() for note in channel.about)]
    raw = _with_numbers(raw, path, notes)
    notes += _written_twice(raw)
    channels = {
        name: _in_si(name, mapping.channels[name], raw[name], mapping, path, notes) for name in raw
    }
    channels = in_ticks(_on_one_clock(channels, mapping, notes), notes)
    for channel in channels.values():
        notes += channel.findings
    start, count = _span(channels, mapping, path)
    missing = [name for name in MEASURED if name not in channels]
    if missing:
        notes.append(f"not measured: {', '.join(missing)}")
    return Record(
        valve_system=mapping.valve_system,
        channels={name: on_grid(channel, start, count) for name, channel in channels.items()},
        nominal=_parameters(mapping, mapping_path),
        boost_table=_boost_table(mapping, mapping_path),
        notes=tuple(notes),
        name=path.stem,
        path=path,
        sha256=sha256(path),
        units={n: spelled(mapping.channels[n].unit or raw[n].unit) for n in channels},
        rates={n: 1.0 / c.period for n, c in channels.items() if c.slow},
    )


def sha256(path: Path) -> str:
    """Return the digest of a file, or of all files of a folder in the order of their names."""
    digest = hashlib.sha256()
    for file in [path] if path.is_file() else sorted(p for p in path.rglob("*") if p.is_file()):
        with file.open("rb") as opened:
            while block := opened.read(1 << 20):
                digest.update(block)
    return digest.hexdigest()


def _with_numbers(raw: dict[str, Raw], path: Path, notes: list[str]) -> dict[str, Raw]:
    """Return the channels that have a number at all; the others are told, as not measured."""
    found = {name: channel for name, channel in raw.items() if np.isfinite(channel.values).any()}
    told = []
    for name, channel in raw.items():
        if name not in found:
            why = "; ".join(channel.notes) or f"none of {len(channel.values)} samples is one"
            told.append(f"{name}: left out, there is no number in it: {why}")
    if not found:
        raise BenchError(f"'{path}': {'; '.join(told)}")
    notes += told
    return found


def _written_twice(raw: dict[str, Raw]) -> list[str]:
    """Return a sentence on each pair of channels that hold the same changing numbers."""
    return [
        f"{first} and {second} hold the same numbers in the file: is one of them written twice?"
        for (first, one), (second, other) in combinations(raw.items(), 2)
        if np.array_equal(one.values, other.values, equal_nan=True) and np.ptp(one.values) != 0.0
    ]


def _in_si(
    name: str, channel: MappedChannel, raw: Raw, mapping: Mapping, path: Path, notes: list[str]
) -> Sampled:
    """Return a channel in SI with the bench's sign, on its own clock in seconds."""
    try:
        found = _channel_in_si(name, channel, raw, mapping, path, notes)
        _check_step(found, raw, mapping)
    except BenchError as error:
        text = str(error)
        raise BenchError(text if str(path) in text else f"'{path}': {text}") from None
    return found


def _channel_in_si(
    name: str, channel: MappedChannel, raw: Raw, mapping: Mapping, path: Path, notes: list[str]
) -> Sampled:
    unit = CHANNELS[name].unit
    notes += [f"{name}: {note}" for note in raw.notes]
    if not channel.unit:
        if not raw.unit:
            raise BenchError(f"{path}: {name}: the file has no unit: give 'unit' in the mapping")
        notes.append(f"{name}: in '{raw.unit}', as the file says")
    elif raw.unit and channel.scale == 1.0 and not same(raw.unit, channel.unit, unit):
        notes.append(
            f"{name}: the file says its unit is '{raw.unit}', the mapping '{channel.unit}': "
            "the mapping was followed"
        )
    shown = channel.unit or raw.unit
    to_si = factor(shown, unit, f"{path}: {name}")
    given = without(raw.values, mapping.missing)
    with np.errstate(over="ignore"):  # What is beyond all numbers is beyond the limits, too.
        values = channel.sign * to_si * (channel.scale * given + channel.offset)
    time = instants(raw, mapping, path, notes) - channel.delay
    kept, told = measured(name, given, values, to_si, shown, raw.lines)
    notes += [f"{name}: {note}" for note in told]
    lines = None if raw.lines is None else raw.lines[kept]
    return sampled(name, time[kept], values[kept], raw.lost, lines)


def instants(raw: Raw, mapping: Mapping, path: Path, notes: list[str]) -> np.ndarray:
    """Return the instants [s]; the mapping's unit goes before the file's, which is told."""
    if raw.time is not None:
        unit = _time_unit(raw, mapping)
        if raw.time_unit and not same(raw.time_unit, unit, "s"):
            note = f"the file says its time is in '{raw.time_unit}', the mapping '{unit}'"
            if f"{note}: the mapping was followed" not in notes:
                notes.append(f"{note}: the mapping was followed")
        return raw.time * factor(unit, "s", f"{path}: time")
    if mapping.rate is None:
        raise BenchError(f"'{path}' has no time: name its column with 'time', or give 'rate' in Hz")
    return np.arange(len(raw.values)) / mapping.rate


def _time_unit(raw: Raw, mapping: Mapping) -> str:
    given = "time_unit" in mapping.model_fields_set
    return mapping.time_unit if given or not raw.time_unit else raw.time_unit


def _check_step(channel: Sampled, raw: Raw, mapping: Mapping) -> None:
    """Raise BenchError where samples come at a step that no record of a steering gear has."""
    short = channel.time[-1] - channel.time[0] < SHORTEST_S  # This is told of all together.
    if (short or channel.period > SHORTEST_STEP_S) and channel.period < LONGEST_STEP_S - 1e-7:
        return
    unit = _time_unit(raw, mapping)
    step = channel.period / factor(unit, "s", "time")
    likely = min(FACTORS["s"], key=lambda u: abs(math.log(step * FACTORS["s"][u] / PERIOD_S)))
    said, key = f"with the time in {unit}", f"`time_unit`, as `time_unit: {likely}`,"
    if raw.time is None:
        said, key = f"at a rate of {mapping.rate:g} Hz", "`rate` in Hz"
    raise BenchError(
        f"{channel.name}: {said} its samples are {channel.period:.3g} s apart; between "
        f"{SHORTEST_STEP_S:g} and {LONGEST_STEP_S:g} s can be judged: say {key} in the mapping"
    )


def _on_one_clock(
    channels: dict[str, Sampled], mapping: Mapping, notes: list[str]
) -> dict[str, Sampled]:
    """Return the channels on the file's first clock; what was done goes into ``notes``."""
    by_clock: dict[str, dict[str, Sampled]] = {}
    for name, channel in channels.items():
        by_clock.setdefault(mapping.channels[name].clock, {})[name] = channel
    reference = by_clock.get("", {})
    moved = dict(reference)
    for clock, members in by_clock.items():
        if not clock:
            continue
        given = mapping.clocks[clock]
        offset, drift = given.offset, given.drift
        if given.estimate:
            found = clocks.estimate(reference, members)
            if found is None:
                raise BenchError(
                    f"clock '{clock}' cannot be estimated: no channel on it moves together with "
                    "one of the first clock; give its offset and drift"
                )
            drift = 1.0 / (1.0 + found.drift) - 1.0
            offset = -found.offset * (1.0 + drift)
            notes.append(
                f"clock '{clock}' was {found.offset * 1e3:.2f} ms late with a drift of "
                f"{found.drift * 1e6:.0f} ppm by {found.pair[0]} against {found.pair[1]} "
                f"(scatter {found.scatter * 1e3:.2f} ms): corrected"
            )
        for name, channel in members.items():
            time = offset + (1.0 + drift) * channel.time
            moved[name] = Sampled(name, time, channel.values, channel.findings, channel.period)
    return moved


def _span(channels: dict[str, Sampled], mapping: Mapping, path: Path) -> tuple[float, int]:
    """Return beginning and number of ticks that all channels share."""
    first = max(channels.values(), key=lambda channel: channel.time[0])
    last = min(channels.values(), key=lambda channel: channel.time[-1])
    start, stop = float(first.time[0]), float(last.time[-1])
    if stop - start < SHORTEST_S:
        raise BenchError(
            f"'{path}': the channels share {max(stop - start, 0.0):.3g} s; at least "
            f"{SHORTEST_S:g} s are needed: {_named(first, mapping)} begins at {start:.6g} s, "
            f"{_named(last, mapping)} ends at {stop:.6g} s (see `time_unit` and `rate`)"
        )
    if stop - start > LONGEST_S:
        pause = int(np.argmax(np.diff(first.time)))
        raise BenchError(
            f"'{path}': the channels share {stop - start:.3g} s, at most {LONGEST_S:g} s can be "
            f"read: cut the file (its longest pause: {first.time[pause]:.6g} to "
            f"{first.time[pause + 1]:.6g} s)"
        )
    return start, int((stop - start) / PERIOD_S + 1e-6) + 1


def _named(channel: Sampled, mapping: Mapping) -> str:
    """Return a channel's name with what moves its time in the mapping."""
    mapped = mapping.channels[channel.name]
    said = [f"delay {mapped.delay:g} s"] if mapped.delay else []
    said += [f"clock '{mapped.clock}'"] if mapped.clock else []
    return channel.name + (f" ({', '.join(said)})" if said else "")


def _parameters(mapping: Mapping, place: Path) -> ParameterSet:
    name = mapping.parameter_set
    try:
        shown = str(place.parent / name) if Path(name).suffix else name
        return load_parameters(shown).with_values(mapping.parameters)
    except ParameterError as error:
        raise BenchError(f"{place}: {error}") from None


def _boost_table(mapping: Mapping, place: Path) -> np.ndarray | None:
    if mapping.boost_curve is None:
        return None
    try:
        return boost_table(read_boost_curve(str(place.parent / mapping.boost_curve)))
    except ValueError as error:
        raise BenchError(f"{place}: boost_curve: {error}") from None
