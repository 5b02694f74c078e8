"""What clean records gain by wrong causes: how much a cause has to gain to be one.

``clean_gains.json`` has the largest gain of each hypothesis over clean records of the benchmark,
for each independent sample of an output; docs/diagnosis_benchmark.md says how it is made.
"""

from __future__ import annotations

import json
from collections.abc import Iterable, Mapping
from functools import cache
from importlib import resources
from pathlib import Path
from typing import Any

from steering_diagnosis.data.bag import record_from_bag
from steering_diagnosis.engine.diagnose import begin
from steering_diagnosis.engine.settings import Settings
from steering_diagnosis.steering.replay import SteeringReplay
from steering_diagnosis.steering.suspicions import suspicions, without

LEAST = 0.2
"""Least gain of any cause."""
BEYOND = 1.5
"""A cause has to gain so much more than clean records do."""

TOLD = 0.05
"""Smaller gains are not kept."""
REFITTED = 8
"""Hypotheses of a clean record that are refitted."""

Gains = Mapping[str, float]


@cache
def clean_gains() -> Mapping[str, Gains]:
    """Return valve system to hypothesis to the largest gain."""
    text = resources.files(__package__).joinpath("clean_gains.json").read_text()
    return dict(json.loads(text)["gains"])


@cache
def settings_of(valve_system: str) -> Settings:
    """Return the engine's settings for records of a valve system."""
    gains = clean_gains().get(valve_system, {})
    return Settings(least_gain=LEAST, least_gains={n: BEYOND * g for n, g in gains.items()})


def gains_of(bag: Path) -> tuple[str, Gains]:
    """Return the valve system of a bag and what its record gains by single causes."""
    record = record_from_bag(bag)
    replay = SteeringReplay(without(record, suspicions(record)))
    search, _ = begin(replay, settings=settings_of(record.valve_system))
    return record.valve_system, search.gains(REFITTED)


def largest(found: Iterable[tuple[str, Gains]]) -> dict[str, Any]:
    """Return the content of ``clean_gains.json`` from what many clean records gained."""
    records: dict[str, int] = {}
    gains: dict[str, dict[str, float]] = {}
    for system, of_record in found:
        records[system] = records.get(system, 0) + 1
        most = gains.setdefault(system, {})
        for name, gain in of_record.items():
            if gain >= TOLD:
                most[name] = round(max(gain, most.get(name, 0.0)), 2)
    ordered = {
        system: dict(sorted(most.items(), key=lambda item: (-item[1], item[0])))
        for system, most in sorted(gains.items())
    }
    return {"records": dict(sorted(records.items())), "gains": ordered}
