"""Rig tests as recorded runs: each run's bag in a folder of its name."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from pathlib import Path
from typing import Any, Literal

import numpy as np

from steering_bringup.bags import read_bag
from steering_bringup.errors import BenchError
from steering_bringup.outcome import Outcome
from steering_bringup.plans import Manner, make_plan
from steering_bringup.scenario_files import check_scenario, load_node_set
from steering_bringup.session import run_all
from steering_core.naming import unknown
from steering_core.yaml_lines import Document
from steering_studies.channels import from_bag
from steering_studies.rig_tests.tests import RIG_TESTS, scenario


def record(
    tests: Iterable[str],
    folder: Path,
    runner: Literal["graph", "direct"],
    parameters: Mapping[str, float],
    effects: Mapping[str, Any],
    on_outcome: Callable[[Outcome], None],
) -> list[Outcome]:
    """Run ``tests`` one after the other, each run recorded to ``folder``/RUN.

    BenchError names an unknown test, or the parameter that cannot be.
    """
    plans = []
    for test in tests:
        if test not in RIG_TESTS:
            raise BenchError(unknown("rig test", test, RIG_TESTS))
        for run in RIG_TESTS[test].runs:
            document = Document(f"rig test '{test}'", scenario(test, run, parameters, effects))
            made = check_scenario(document, Path())
            node_set = load_node_set(made.node_set[0])
            plans.append(make_plan(made, node_set, Manner(runner), folder / run))
    return run_all(plans, on_outcome, None, print)


def recorded(places: Iterable[Path]) -> dict[str, dict[str, np.ndarray]]:
    """Return the channels of recorded runs by the run's name, from bags or folders of bags.

    A run is known by its scenario's name, or by its folder's where the bag tells none.
    """
    runs: dict[str, dict[str, np.ndarray]] = {}
    for place in places:
        for bag in _bags(place):
            trace = read_bag(bag)
            told = trace.run.get("scenario") if isinstance(trace.run, dict) else None
            name = str(told.get("name")) if isinstance(told, dict) and told else bag.name
            if name in runs:
                raise BenchError(f"'{bag}': there are two runs of the rig test '{name}'")
            runs[name] = from_bag(trace)
    return runs


def _bags(place: Path) -> list[Path]:
    if not place.exists():
        raise BenchError(f"there is no bag or folder '{place}'")
    if place.is_file() or any(place.glob("*.mcap")) or (place / "metadata.yaml").exists():
        return [place]
    inside = sorted({file.parent for file in place.glob("*/*.mcap")})
    if not inside:
        raise BenchError(f"'{place}' holds no bags")
    return inside
