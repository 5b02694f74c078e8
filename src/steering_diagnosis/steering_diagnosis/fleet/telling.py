"""A fleet's verdict as lines, as JSON, and as the part of a scenario that extends the model."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import asdict
from statistics import mean
from typing import Any

from steering_diagnosis.fleet.shift import Shift
from steering_diagnosis.fleet.verdict import Fleet
from steering_diagnosis.pages.shown import words
from steering_diagnosis.report import Report

SHOWN = 8
"""Parameters of the table at most: those that are shifted, and the next ones."""


def lines(fleet: Fleet, failed: Mapping[str, str]) -> list[str]:
    """Return what the terminal shows."""
    count = len(fleet.members)
    told = [f"{count} specimens judged"]
    for cause, members in fleet.common.items():
        told.append(f"common: {words(cause)}, named in {len(members)} of {count}")
    inside = [s for s in fleet.shifts if s.common and s.name in fleet.inside]
    told += [f"  {s.name}: {_value(s)}" for s in inside]
    for s in fleet.shifted:
        told.append(f"common: {s.name} is off alike in all: {_value(s)}")
    if not fleet.common and not fleet.shifted:
        told.append("common: nothing; the data sheet holds for the fleet")
    for name, causes in fleet.single.items():
        told.append(f"single: {name}: {', '.join(words(c) for c in causes)}")
    told += [f"unexplained: {name}" for name in fleet.unexplained]
    told += [f"not judged: {name}: {why}" for name, why in failed.items()]
    return [*told, "", *table(fleet)]


def _value(s: Shift) -> str:
    off = f"{(s.value / s.nominal - 1.0) * 100.0:+.1f} %" if s.nominal else f"{s.value:+.3g}"
    return f"{s.value:.4g} for {s.nominal:.4g} ({off}, {abs(s.mean) / s.sd:.1f} sigma)"


def table(fleet: Fleet) -> list[str]:
    """Return the parameters' table: the fleet's mean and scatter, against the tolerances."""
    rows = [s for s in fleet.shifts if s.judged]
    shown = [s for i, s in enumerate(rows) if s.common or i < SHOWN]
    head = f"{'parameter':44} {'data sheet':>11} {'fleet':>11} {'+-':>9} {'scatter':>8}"
    body = [
        f"{s.name:44} {s.nominal:11.5g} {s.value:11.5g} {s.sd * s.deviation:9.2g} {s.scatter:8.2f}"
        for s in shown
    ]
    foot = "scatter: of the specimens, over that of the tolerance"
    rest = len(fleet.shifts) - len(shown)
    return [head, *body, f"{foot}; {rest} more in fleet.json"] if body else []


def document(fleet: Fleet, failed: Mapping[str, str]) -> dict[str, Any]:
    """Return ``fleet.json``, schema 1."""
    return {
        "schema": 1,
        "members": list(fleet.members),
        "common": {cause: list(members) for cause, members in fleet.common.items()},
        "single": {name: list(causes) for name, causes in fleet.single.items()},
        "unexplained": list(fleet.unexplained),
        "failed": dict(failed),
        "parameters": [
            {k: None if isinstance(v, float) and math.isnan(v) else v for k, v in asdict(s).items()}
            | {"value": s.value}
            for s in fleet.shifts
        ],
    }


def extension(fleet: Fleet, reports: Mapping[str, Report]) -> dict[str, Any]:
    """Return the part of a scenario by which the fleet extends the model; empty: by nothing.

    Common causes with the mean of their sizes, and parameters that are off alike. A parameter that
    a common cause changes is in that cause.
    """
    effects: dict[str, dict[str, float]] = {}
    parameters: dict[str, float] = {}
    for cause, members in fleet.common.items():
        sizes = [
            {n: e.value for n, e in c.parameters.items()}
            for m in members
            for c in reports[m].causes
            if c.effect == cause
        ]
        means = {name: mean(size[name] for size in sizes) for name in sizes[0]}
        if ":" in cause:
            parameters |= means
        else:
            effects[cause] = means
    parameters |= {s.name: s.value for s in fleet.shifted}
    found: dict[str, Any] = {"effects": effects} if effects else {}
    return found | ({"parameters": parameters} if parameters else {})
