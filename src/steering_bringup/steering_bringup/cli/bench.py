"""``steer bench``: speed and accuracy, measured beside their targets."""

from __future__ import annotations

import argparse
import json
import subprocess
import sys
import tempfile
from pathlib import Path
from typing import Any

from steering_bringup.errors import BenchError
from steering_core.naming import unknown

EXAMPLES = """examples:
  steer bench
  steer bench graph_speed --json graph.json
  steer bench diagnosis --cases 200 --records records --method engine

A benchmark is a file benchmarks/NAME.py that takes --json FILE. It prints a table, writes its
numbers to the file, and ends with status 0 where they were measured."""

OF_DIAGNOSIS = (
    "cases",
    "kinds",
    "seed",
    "records",
    "method",
    "jobs",
    "page",
    "doors",
    "without",
    "calibrate",
    "clean_gains",
)
"""Options that are handed on to the sealed benchmark of diagnosis, with --full and --missing."""


def arguments(parser: argparse.ArgumentParser) -> None:
    """Declare the options."""
    add = parser.add_argument
    add("names", metavar="NAME", nargs="*", help="benchmarks to run (default: all)")
    add("--list", action="store_true", help="list the benchmarks")
    add(
        "--json",
        metavar="FILE",
        type=Path,
        default=Path("results/bench.json"),
        help="numbers of all of them (default: results/bench.json)",
    )
    sealed = parser.add_argument_group("of the benchmark 'diagnosis' (docs/diagnosis_benchmark.md)")
    add = sealed.add_argument
    add("--cases", metavar="N", help="cases; 200 for the whole benchmark (default: 20)")
    add("--full", action="store_true", help="200 cases; of the clean 300, outside 60")
    add("--missing", action="store_true", help="the same cases with all channels, and without some")
    add("--kinds", metavar="KIND", nargs="+", help="clean, visible, invisible, pair, outside")
    add("--seed", metavar="S", help="other records for another seed")
    add(
        "--records", metavar="DIR", help="keep bags, truths and results; a second run goes on there"
    )
    add("--method", metavar="MODULE:FUNCTION", help="bag to report; or engine, baseline")
    add("--jobs", metavar="N", help="processes (default: 2)")
    add(
        "--doors",
        metavar="DOOR",
        help="all, bag, csv, mdf or matlab: what the cases come in through",
    )
    add("--without", metavar="GROUP", nargs="+", help="channels that no case has")
    add("--calibrate", metavar="MODULE:FUNCTION", help="a statistic over N clean records instead")
    add("--clean-gains", metavar="FILE", help="what N clean records gain by wrong causes instead")
    add("--page", metavar="FILE", help="the HTML page (default: in --records)")


def execute(options: argparse.Namespace) -> int:
    """Run the benchmarks one after the other and gather their numbers."""
    found = benchmarks()
    for name in options.names:
        if name not in found:
            raise BenchError(unknown("benchmark", name, found))
    if options.list:
        print("\n".join(found))
        return 0
    more = _of_diagnosis(options)
    chosen = {
        name: path for name, path in found.items() if not options.names or name in options.names
    }
    report = {"machine": _surroundings(), "benchmarks": {}}
    failed = []
    for name, path in chosen.items():
        print(f"== {name}", flush=True)
        status, numbers = _measure(path, more if name == "diagnosis" else [])
        report["benchmarks"][name] = numbers
        failed += [name] if status else []
    options.json.parent.mkdir(parents=True, exist_ok=True)
    options.json.write_text(json.dumps(report, indent=2) + "\n", encoding="utf-8")
    print(f"numbers: {options.json}")
    if failed:
        raise BenchError(f"not measured or below a target: {', '.join(failed)}")
    return 0


def benchmarks() -> dict[str, Path]:
    """Return name to file of the project's benchmarks."""
    folders = (parent / "benchmarks" for parent in Path(__file__).resolve().parents)
    folder = next((f for f in folders if f.is_dir()), None)
    if folder is None:
        raise BenchError("the folder 'benchmarks' is not there: run from the project's source tree")
    return {p.stem: p for p in sorted(folder.glob("*.py")) if not p.stem.startswith("_")}


def _of_diagnosis(options: argparse.Namespace) -> list[str]:
    """Return what is handed on to the benchmark of diagnosis; BenchError where it does not run."""
    given = {name: getattr(options, name) for name in OF_DIAGNOSIS if getattr(options, name)}
    more = [f"--{name}" for name in ("full", "missing") if getattr(options, name)]
    for name, value in given.items():
        more += [f"--{name.replace('_', '-')}", *(value if isinstance(value, list) else [value])]
    if more and "diagnosis" not in options.names:
        raise BenchError(f"{more[0]} belongs to the benchmark 'diagnosis': steer bench diagnosis")
    return more


def _measure(path: Path, more: list[str]) -> tuple[int, Any]:
    with tempfile.TemporaryDirectory() as folder:
        file = Path(folder, "numbers.json")
        status = subprocess.call([sys.executable, str(path), "--json", str(file), *more])
        numbers = json.loads(file.read_text(encoding="utf-8")) if file.is_file() else None
    return status, numbers


def _surroundings() -> dict[str, Any]:
    import os

    from steering_bringup.bags.run_metadata import libraries, machine, software

    return {"software": software(), "libraries": libraries(), **machine(), "cpus": os.cpu_count()}
