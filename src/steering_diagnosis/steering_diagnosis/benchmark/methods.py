"""Methods that the benchmark can judge: this project's engine, the baseline, or anybody's."""

from __future__ import annotations

import importlib
import inspect
from collections.abc import Callable
from pathlib import Path
from typing import Any

from steering_core.errors import BenchError

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


def call(method: Callable[..., Any], bag: Path, holdout: Path) -> dict[str, Any]:
    """Return a method's report; the held-out bag goes to those that have a place for it."""
    more = {"holdout": holdout} if "holdout" in inspect.signature(method).parameters else {}
    report = method(bag, **more)
    if not isinstance(report, dict) or not isinstance(report.get("causes", []), list):
        raise BenchError("a method must return a dictionary as report.json has it")
    return report


def engine(bag: Path, holdout: Path) -> dict[str, Any]:
    """Return the report of this project's diagnosis."""
    from steering_diagnosis.data.bag import record_from_bag

    diagnose_record = load_function("steering_diagnosis.steering.diagnose_record:diagnose_record")
    diagnosis = diagnose_record(
        record_from_bag(bag), record_from_bag(holdout), executor=None, progress=None
    )
    return dict(diagnosis.report.model_dump(mode="json", by_alias=True))
