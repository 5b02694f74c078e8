"""A case as a bag of the bench and as a record: measurements and commands, nothing true in it."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np

from steering_bringup.bags import BagWriter, run_metadata
from steering_bringup.scenario_files import load_node_set
from steering_core.parameters import ParameterSet
from steering_diagnosis.benchmark.doors.channel_sets import LACKABLE
from steering_diagnosis.benchmark.truth.run import Signals
from steering_diagnosis.data.channels import CHANNELS, COMMANDED, MEASURED
from steering_diagnosis.data.record import Record
from steering_lockstep.topics import CLOCK, TABLE, wire
from steering_lockstep.wire import NANOSECONDS_PER_TICK

STARTED = "2000-01-01T00:00:00+00:00"
"""Every bag claims this, so that the same seed gives the same bytes."""


def topics(signals: Signals, closed: bool) -> dict[str, np.ndarray]:
    """Return the messages' fields by topic, (n, fields)."""
    measured = signals.measured
    found = {
        "/steering/torque": measured[:, :3],
        "/steering/pressure": measured[:, 3:6],
        "/steering/rack": measured[:, 6:],
        "/driver/torque": signals.driver,
    }
    if closed:
        found |= {"/valve/left/command": signals.left, "/valve/right/command": signals.right}
    return found | {"/vehicle/rack_force": signals.load, CLOCK: np.empty((len(measured), 0))}


def write_case(
    folder: Path,
    signals: Signals,
    nominal: ParameterSet,
    system: str,
    load: str,
    lacking: Sequence[str] = (),
) -> None:
    """Write the bag of a case, with the run's metadata as the bench would: nominal, no effects.

    lacking: groups of channels (doors.channel_sets) that are not measured.
    """
    columns = _without(topics(signals, system == "closed_centre"), lacking)
    types = {topic: TABLE[topic].type_name.replace("/", "/msg/") for topic in columns}
    ticks = np.arange(len(signals.measured), dtype=np.int64)
    rows = {}
    for topic, values in columns.items():
        layout = wire(topic)
        messages = layout.from_columns(ticks, values)
        rows[topic] = messages.view(np.uint8).reshape(len(ticks), layout.size)
    with BagWriter(folder, types, metadata(nominal, system, load), overwrite=True) as writer:
        for start in range(0, len(ticks), 1000):
            part = slice(start, start + 1000)
            block = {topic: values[part] for topic, values in rows.items()}
            writer.write_block(ticks[part] * NANOSECONDS_PER_TICK, block)


def _without(columns: dict[str, np.ndarray], lacking: Sequence[str]) -> dict[str, np.ndarray]:
    """Return the topics without what is not measured: NaN, and no topic of which nothing is left.

    That is how a rig's bag has it.
    """
    for group in lacking:
        for channel in LACKABLE[group]:
            place = CHANNELS[channel]
            if place.topic in columns:
                values = columns[place.topic].copy()
                values[:, wire(place.topic).fields.index(place.field)] = np.nan
                columns[place.topic] = values
    return {t: v for t, v in columns.items() if not v.shape[1] or not np.isnan(v).all()}


def metadata(nominal: ParameterSet, system: str, load: str) -> dict[str, Any]:
    """Return what the bag says of its run."""
    return run_metadata(
        scenario={"name": "benchmark", "load": {"kind": load}},
        node_set=load_node_set(system).model_dump(mode="json", by_alias=True),
        parameters=nominal.flat(),
        runner="direct",
        started=STARTED,
    )


def channels_of(signals: Signals, system: str) -> dict[str, np.ndarray]:
    """Return all channels that a gear of a valve system has, (n,) each, SI."""
    by_topic = topics(signals, system == "closed_centre")
    channels = {}
    for channel, where in CHANNELS.items():
        if where.topic in by_topic:
            column = wire(where.topic).fields.index(where.field)
            channels[channel] = np.ascontiguousarray(by_topic[where.topic][:, column])
    assert set(MEASURED) <= set(channels) <= set(MEASURED) | set(COMMANDED)
    return channels


def record_of(signals: Signals, nominal: ParameterSet, system: str, load: str, name: str) -> Record:
    """Return the record that reading the bag would give, without writing it."""
    channels = channels_of(signals, system)
    return Record(system, channels, nominal, name=name, vehicle_load=load)  # type: ignore[arg-type]
