"""The command line of every benchmark: size, table, JSON file, last line and exit status."""

from __future__ import annotations

import argparse
import json
import os
import sys
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from steering_bringup.benchmarking.registry import BENCHMARKS
from steering_bringup.benchmarking.rows import Benchmark, missed, verdict
from steering_core.errors import BenchError


@dataclass(frozen=True)
class Measured:
    """Values by the name of their row; ``details``: whatever else belongs into the file."""

    values: Mapping[str, float | None]
    details: Any = field(default_factory=dict)


def main(
    name: str,
    measure: Callable[[argparse.Namespace], Measured],
    arguments: Callable[[argparse.ArgumentParser], None],
    about: str | None,
    argv: list[str] | None = None,
) -> int:
    """Measure, print and write; return 0 where each target is met, else 1.

    ``arguments`` declares the benchmark's own options, ``about`` is its module's text.
    """
    benchmark = BENCHMARKS[name]
    options = _options(benchmark, arguments, about, argv)
    try:
        measured = measure(options)
    except BenchError as error:
        print(f"{name}: {error}", file=sys.stderr)
        return 1
    show(benchmark, entries_of(benchmark, measured.values))
    return finish(benchmark, measured, options.json, options.quick)


def finish(benchmark: Benchmark, measured: Measured, file: Path | None, quick: bool) -> int:
    """Write the numbers, print the verdict as the last line and return the exit status."""
    entries = entries_of(benchmark, measured.values)
    if file:
        content = {
            "benchmark": benchmark.name,
            "quick": quick,
            "rows": entries,
            "load_average": os.getloadavg()[0],
            "details": measured.details,
        }
        file.parent.mkdir(parents=True, exist_ok=True)
        file.write_text(json.dumps(content, indent=2) + "\n", encoding="utf-8")
    print(verdict(benchmark.name, entries), flush=True)
    return 1 if missed(entries) else 0


def entries_of(
    benchmark: Benchmark, values: Mapping[str, float | None]
) -> dict[str, dict[str, Any]]:
    """Return the rows of the JSON file; ValueError for a value that has no row."""
    strange = set(values) - {row.name for row in benchmark.rows}
    if strange:
        raise ValueError(f"{benchmark.name} has no row {', '.join(sorted(strange))}")
    return {row.name: row.entry(values.get(row.name)) for row in benchmark.rows}


def show(benchmark: Benchmark, entries: Mapping[str, Mapping[str, Any]]) -> None:
    """Print the table of all rows that were measured."""
    for row in benchmark.rows:
        entry = entries[row.name]
        if entry["value"] is not None:
            outcome = "  MISSED" if entry["reached"] is False else ""
            figure = f"{entry['text']} {row.unit}".strip()
            print(f"{row.what:58} {figure:>14}   {entry['target']}{outcome}".rstrip())


def _options(
    benchmark: Benchmark,
    arguments: Callable[[argparse.ArgumentParser], None],
    about: str | None,
    argv: list[str] | None,
) -> argparse.Namespace:
    parser = argparse.ArgumentParser(
        description=about, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--json", type=Path, metavar="FILE", help="write the numbers there")
    parser.add_argument("--quick", action="store_true", help="the smallest size, seconds long")
    arguments(parser)
    known, _ = parser.parse_known_args(argv)
    if known.quick:
        parser.set_defaults(**benchmark.quick)
    return parser.parse_args(argv)
