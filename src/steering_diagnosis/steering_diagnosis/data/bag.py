"""A bag of the bench or of the rig bridge as a record. What is true in it is never looked at."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np

from steering_bringup.bags import Trace, read_bag
from steering_core.errors import BenchError
from steering_core.parameters import ParameterError, ParameterSet, load_parameters
from steering_diagnosis.data.channels import CHANNELS, MEASURED, PRESSURE, TORQUE
from steering_diagnosis.data.read import sha256
from steering_diagnosis.data.record import Record
from steering_diagnosis.data.rig_run import LOAD, as_on_the_rig
from steering_lockstep.topics import LOAD_COMMAND
from steering_plant.measured_boost_curve import boost_table

TOPICS = frozenset(channel.topic for channel in CHANNELS.values())
"""All topics that a record is made of; no other one is read."""


def record_from_bag(path: str | Path) -> Record:
    """Return the record of a bag. BenchError: no bag, or not one of a steering gear."""
    path = Path(path)
    trace = read_bag(path, repair_damage=False, topics=TOPICS)
    ticks = _ticks(trace, path)
    grid = np.arange(ticks[0], ticks[-1] + 1)
    notes = [str(note) for note in trace.notes]
    channels = {}
    for name, channel in CHANNELS.items():
        if channel.topic in trace and channel.field in (trace[channel.topic].dtype.names or ()):
            values = _on_grid(trace[channel.topic], channel.field, grid)
            if np.isfinite(values).any():
                channels[name] = values
    idle = as_on_the_rig(channels, trace.run, int(ticks[0]), notes)
    _without_load_command(channels, trace, notes)
    if not np.any(channels.get("driver_torque", 0.0)):
        channels.pop("driver_torque", None)  # Nobody commanded it: a rig without a driver.
    missing = [name for name in MEASURED if name not in channels]
    if missing:
        notes.append(f"not measured: {', '.join(missing)}")
    excluded = _gaps(channels, notes)
    if idle is not None:
        excluded = idle if excluded is None else excluded | idle
    return Record(
        valve_system=_valve_system(trace, channels),
        channels=channels,
        nominal=_nominal(trace.run, path),
        boost_table=_boost_table(trace.run),
        excluded=excluded,
        notes=tuple(notes),
        name=path.name,
        path=path,
        sha256=sha256(path),
        vehicle_load=str(_scenario(trace.run).get("load", {}).get("kind", "")),
    )


def _ticks(trace: Trace, path: Path) -> np.ndarray:
    """Return the ticks at which the steering gear was measured."""
    for topic in (TORQUE, PRESSURE):
        if topic in trace and "tick" in (trace[topic].dtype.names or ()):
            ticks = np.unique(trace[topic]["tick"].astype(np.int64))
            if len(ticks) > 1:
                return ticks
    have = ", ".join(sorted(trace.topics)) or "nothing"
    raise BenchError(f"'{path}' is no bag of a steering gear: no {TORQUE} in it; it has {have}")


def _on_grid(rows: np.ndarray, field: str, grid: np.ndarray) -> np.ndarray:
    """Return a field on the grid of ticks, NaN where there is no message."""
    values = np.full(len(grid), np.nan)
    at = rows["tick"].astype(np.int64) - grid[0]
    inside = (at >= 0) & (at < len(grid))
    values[at[inside]] = rows[field][inside]
    return values


def _gaps(channels: Mapping[str, np.ndarray], notes: list[str]) -> np.ndarray | None:
    """Note missing ticks; return the samples of the measured ones, None where all are there."""
    missing = [~np.isfinite(v) for n, v in channels.items() if n in MEASURED]
    excluded = np.any(missing, axis=0) if missing else np.zeros(0, dtype=bool)
    if not excluded.any():
        return None
    starts = int(np.sum(np.diff(np.concatenate([[0], excluded.astype(int)])) > 0))
    notes.append(
        f"{int(excluded.sum())} of {len(excluded)} ticks are missing in {starts} gaps: bridged for "
        "the inputs of the replay, and not judged"
    )
    return excluded


def _without_load_command(channels: dict[str, np.ndarray], trace: Trace, notes: list[str]) -> None:
    """Leave out the load's command where a load cylinder follows it: the force lags behind it."""
    nodes = (trace.run.get("node_set") or {}).get("nodes") or {}
    if not any(LOAD_COMMAND in (node.get("outputs") or ()) for node in nodes.values()):
        return
    for name in LOAD:
        channels.pop(name, None)
    notes.append("a load cylinder makes the load: what it was asked for is not used, its cell is")


def _valve_system(trace: Trace, channels: Mapping[str, np.ndarray]) -> Any:
    named = (trace.run.get("node_set") or {}).get("valve_system")
    if named:
        return named
    return "closed_centre" if "left_solenoid_force" in channels else "open_centre"


def _scenario(run: Mapping[str, Any]) -> Mapping[str, Any]:
    """Return what the metadata say of the scenario, never of its effects."""
    scenario = run.get("scenario") or {}
    return {key: scenario[key] for key in ("load", "boost_curve") if scenario.get(key)}


def _nominal(run: Mapping[str, Any], path: Path) -> ParameterSet:
    try:
        return load_parameters().with_values(run.get("parameters") or {})
    except ParameterError as error:
        raise BenchError(f"'{path}': parameters in its metadata: {error}") from None


def _boost_table(run: Mapping[str, Any]) -> np.ndarray | None:
    points = _scenario(run).get("boost_curve")
    return boost_table(points) if points else None
