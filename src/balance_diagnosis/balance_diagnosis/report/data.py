"""A diagnosis as plain data: report.json, schema 1, and what the page is made from."""

from __future__ import annotations

from dataclasses import asdict, is_dataclass
from importlib.metadata import PackageNotFoundError, version
from typing import Any

from balance_diagnosis.constants import DEFAULT
from balance_diagnosis.diagnosis import Diagnosis
from balance_diagnosis.intervals import Estimate
from balance_diagnosis.record import Record
from balance_diagnosis.report import words

SCHEMA = 1


def described(diagnosis: Diagnosis, rates: Any = None, call: str = "") -> dict[str, Any]:
    """Return all that is told, as mappings, lists, texts and numbers."""
    verdict = diagnosis.verdict
    units = diagnosis.model.units
    return {
        "schema": SCHEMA,
        "model": diagnosis.model.name,
        "call": call or called(diagnosis),
        "library": library_version(),
        "verdict": verdict.word,
        "meaning": words.MEANING[verdict.word],
        "sentence": words.sentence(diagnosis),
        "gain": words.gained(diagnosis, output_units(diagnosis)),
        "named": list(verdict.named),
        "groups": [list(group) for group in verdict.groups],
        "candidates": list(verdict.candidates),
        "probability": {**verdict.probability},
        "probability_of_none": verdict.none,
        "refused": {**verdict.refused},
        "cannot_see": {**verdict.cannot_see},
        "left": verdict.left,
        "predictable": verdict.predictable,
        "causes": {
            cause: {name: _estimate(e, units) for name, e in numbers.items()}
            for cause, numbers in diagnosis.causes.items()
        },
        "parameters": {
            n.name: _estimate(n, units) for n in diagnosis.numbers if not n.cause and not n.record
        },
        "starts": _starts(diagnosis),
        "nominal_parameters": {
            n.name: _estimate(n, units) for n in diagnosis.nominal if not n.record
        },
        "errors": [asdict(gain) for gain in diagnosis.gains],
        "remaining": [asdict(band) for band in diagnosis.remaining],
        "noise": {**diagnosis.noise},
        "typical": diagnosis.typical,
        "rates": asdict(rates) if is_dataclass(rates) and not isinstance(rates, type) else rates,
        "records": [
            *(_record(record, False) for record in diagnosis.fit),
            *(_record(record, True) for record in diagnosis.holdout),
        ],
        "constants": {row["name"]: row["value"] for row in diagnosis.constants.table()},
        "model_calls": diagnosis.calls,
        "failed_calls": {**diagnosis.failures},
    }


def output_units(diagnosis: Diagnosis) -> dict[str, str]:
    """Return channel to unit, as the records tell it."""
    found: dict[str, str] = {}
    for record in (*diagnosis.holdout, *diagnosis.fit):
        found.update(record.units)
    return found


def called(diagnosis: Diagnosis) -> str:
    """Return the call as it is written in a program, records by their names."""
    parts = ["model", f"fit={[record.name for record in diagnosis.fit]}"]
    if diagnosis.holdout:
        parts.append(f"holdout={[record.name for record in diagnosis.holdout]}")
    if diagnosis.constants != DEFAULT:
        usual = {row["name"]: row["value"] for row in DEFAULT.table()}
        other = ", ".join(
            f"{row['name']}={row['value']:g}"
            for row in diagnosis.constants.table()
            if row["value"] != usual[row["name"]]
        )
        parts.append(f"constants=Constants({other})")
    return f"diagnose({', '.join(parts)})"


def library_version() -> str:
    """Return the installed version, "" of a source tree that is not installed."""
    try:
        return version("balance_diagnosis")
    except PackageNotFoundError:
        return ""


def _estimate(estimate: Estimate, units: dict[str, str]) -> dict[str, Any]:
    return {
        "value": estimate.value,
        "low": estimate.low,
        "high": estimate.high,
        "unit": units.get(estimate.name, ""),
    }


def _starts(diagnosis: Diagnosis) -> dict[str, dict[str, Any]]:
    found: dict[str, dict[str, Any]] = {}
    for number in diagnosis.numbers:
        if number.record:
            entry = _estimate(number, diagnosis.model.units)
            found.setdefault(number.record, {})[number.name] = entry
    return found


def _record(record: Record, held_out: bool) -> dict[str, Any]:
    return {
        "name": record.name,
        "held_out": held_out,
        "samples": len(record),
        "seconds": float(record.times[-1] - record.times[0]),
        "period": record.period,
        "channels": {key: record.units.get(key, "") for key in record.channels},
        "sha256": record.digest(),
    }
