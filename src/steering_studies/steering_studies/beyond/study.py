"""What a study is: a question, and a function that answers it with numbers and figures."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from typing import Any

from steering_bringup.cores import build_cores
from steering_bringup.direct.runner import DirectTrace, run
from steering_bringup.pages import Figure
from steering_bringup.scenario_files import load_node_set
from steering_bringup.schema import Scenario


@dataclass(frozen=True)
class Table:
    """A table of the page: head and rows of texts; the first column is text."""

    head: Sequence[str]
    rows: Sequence[Sequence[str]]


@dataclass(frozen=True)
class Answer:
    """A study's result. sentence: the answer. numbers: for machines, SI unless the name tells."""

    sentence: str
    numbers: dict[str, Any]
    figures: Sequence[Figure] = ()
    tables: Sequence[Table] = ()
    notes: Sequence[str] = field(default_factory=tuple)


@dataclass(frozen=True)
class Study:
    """A question and what answers it, with the data sheet's parameters changed as given."""

    name: str
    question: str
    answer: Callable[[dict[str, float]], Answer]


def simulate(document: dict[str, Any], parameters: dict[str, float]) -> DirectTrace:
    """Run a scenario given as data, with ``parameters`` on top of its own, without ROS."""
    given = {**document.get("parameters", {}), **parameters}
    scenario = Scenario.model_validate(
        {"schema": 1, "name": "study", **document, "parameters": given, "truth": False}
    )
    cores = build_cores(scenario, load_node_set(scenario.node_set[0]))
    return run(cores, scenario.ticks)
