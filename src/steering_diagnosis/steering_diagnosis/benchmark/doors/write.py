"""A case written through its door: record, held-out record, and the mapping beside them."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import numpy as np
import yaml

from steering_core.parameters import ParameterSet
from steering_diagnosis.benchmark.bags import channels_of, write_case
from steering_diagnosis.benchmark.doors.channel_sets import lacking_in, measured
from steering_diagnosis.benchmark.doors.door import BAG, Door
from steering_diagnosis.benchmark.doors.files import WRITERS, as_in_a_file
from steering_diagnosis.benchmark.doors.logger import logged
from steering_diagnosis.benchmark.truth.run import Signals

NOISE_STREAM = 17


@dataclass(frozen=True)
class Paths:
    """Where a case lies. mapping: None for a bag."""

    record: Path
    holdout: Path
    mapping: Path | None

    def there(self) -> bool:
        """Return whether all of it is written."""
        return all(p.exists() for p in (self.record, self.holdout, self.mapping) if p is not None)


def paths(door: Door, folder: Path, name: str) -> Paths:
    """Return where a case lies that comes in through ``door``."""
    if door.kind == BAG:
        return Paths(folder / name, folder / f"{name}-holdout", None)
    ending = WRITERS[door.kind][0]
    return Paths(
        folder / f"{name}{ending}", folder / f"{name}-holdout{ending}", folder / f"{name}.yaml"
    )


def write_through(
    door: Door, path: Path, signals: Signals, nominal: ParameterSet, system: str, load: str
) -> None:
    """Write a record through a door."""
    lacking = lacking_in(system, door.lacking)
    if door.kind == BAG:
        write_case(path, signals, nominal, system, load, lacking)
        return
    channels = measured(channels_of(signals, system), lacking)
    random = np.random.default_rng([NOISE_STREAM, *path.stem.encode()])
    path.parent.mkdir(parents=True, exist_ok=True)
    time, there = logged(as_in_a_file(channels), door.logger, random)
    WRITERS[door.kind][1](path, time, there, door.logger, door.way)


def write_mapping(door: Door, path: Path, signals: Signals, system: str) -> None:
    """Write the mapping to a case's files."""
    channels = measured(channels_of(signals, system), lacking_in(system, door.lacking))
    content = WRITERS[door.kind][2](system, channels, door.logger, door.way)
    path.write_text(yaml.safe_dump(content, sort_keys=False), encoding="utf-8")
