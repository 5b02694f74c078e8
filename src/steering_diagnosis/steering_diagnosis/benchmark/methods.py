"""Methods that the benchmark can judge: this project's engine, the baseline, or anybody's."""

from __future__ import annotations

import importlib
import inspect
from collections.abc import Callable
from pathlib import Path
from typing import Any

from steering_core.errors import BenchError
from steering_diagnosis.benchmark.doors.write import Paths

NAMED = {
    "engine": "steering_diagnosis.benchmark.methods:engine",
    "baseline": "steering_diagnosis.benchmark.baseline:baseline",
}
"""Short names of the methods that come along."""


def load_function(text: str) -> Callable[..., Any]:
    """Return the function MODULE:FUNCTION; BenchError where it is not there."""
    module, _, name = NAMED.get(text, text).partition(":")
    try:
        found = getattr(importlib.import_module(module), name)
    except (ImportError, AttributeError, ValueError) as error:
        raise BenchError(
            f"method '{text}' cannot be loaded ({error}): give MODULE:FUNCTION, "
            f"or one of {', '.join(NAMED)}"
        ) from None
    return found


def call(method: Callable[..., Any], at: Paths) -> dict[str, Any]:
    """Return a method's report; it gets the held-out record and the mapping if it has the place."""
    places = inspect.signature(method).parameters
    given = {"holdout": at.holdout, "mapping": at.mapping}
    report = method(at.record, **{name: path for name, path in given.items() if name in places})
    if not isinstance(report, dict) or not isinstance(report.get("causes", []), list):
        raise BenchError("a method must return a dictionary as report.json has it")
    return report


def engine(record: Path, holdout: Path, mapping: Path | None = None) -> dict[str, Any]:
    """Return the report of this project's diagnosis."""
    from steering_diagnosis.data.read import read_record

    diagnose_record = load_function("steering_diagnosis.steering.diagnose_record:diagnose_record")
    diagnosis = diagnose_record(
        read_record(record, mapping), read_record(holdout, mapping), executor=None, progress=None
    )
    return dict(diagnosis.report.model_dump(mode="json", by_alias=True))
