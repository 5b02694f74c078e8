"""``steer bench``: speed and accuracy, measured beside their targets."""

from __future__ import annotations

import argparse
import json
import os
import subprocess
import sys
import tempfile
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from steering_bringup.benchmarking import figures
from steering_bringup.benchmarking.registry import BENCHMARKS
from steering_bringup.benchmarking.rows import missed
from steering_bringup.errors import BenchError
from steering_bringup.outputs import write_json
from steering_core.naming import unknown

EXAMPLES = """examples:
  steer bench
  steer bench --quick
  steer bench graph_speed --json graph.json
  steer bench --readme
  steer bench diagnosis --cases 200 --records records --method engine

Each target that was missed is named in the last line; the exit status is 0 only where none was and
all was measured. Targets about time are ratios of two times of the same run. A benchmark is a
program benchmarks/NAME.py; 'steer python benchmarks/NAME.py --help' has its sizes."""

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
    "diff",
)
"""Options that are handed on to the sealed benchmark of diagnosis, with --full and --missing."""


def arguments(parser: argparse.ArgumentParser) -> None:
    """Declare the options."""
    add = parser.add_argument
    add("names", metavar="NAME", nargs="*", help="benchmarks to run (default: all)")
    add("--list", action="store_true", help="list the benchmarks")
    add("--quick", action="store_true", help="the smallest size of each, seconds long")
    add(
        "--readme",
        action="store_true",
        help="write the figures into README.md and docs (default: the benchmarks named there)",
    )
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
    add("--diff", metavar="DIR", help="only tell what differs from the results kept in DIR")
    add("--page", metavar="FILE", help="the HTML page (default: in --records)")


def execute(options: argparse.Namespace) -> int:
    """Run the benchmarks one after the other and gather their numbers."""
    for name in options.names:
        if name not in BENCHMARKS:
            raise BenchError(unknown("benchmark", name, BENCHMARKS))
    if options.list:
        for benchmark in BENCHMARKS.values():
            print(f"{benchmark.name:22} {benchmark.about}")
        return 0
    if options.readme and options.quick:
        raise BenchError("--readme takes the whole size: leave --quick out")
    more = _of_diagnosis(options)
    root = project()
    documented = figures.named(root) if options.readme else set(BENCHMARKS)
    names = [n for n in BENCHMARKS if n in (options.names or documented)]
    report: dict[str, Any] = {"machine": _surroundings(), "benchmarks": {}}
    for name in names:
        print(f"== {name}", flush=True)
        words = [*(["--quick"] if options.quick else []), *(more if name == "diagnosis" else [])]
        report["benchmarks"][name] = _measure(root / "benchmarks" / f"{name}.py", words)
    write_json(options.json, report)
    if options.readme:
        _write_figures(root, report["benchmarks"])
    print(f"numbers: {options.json}", flush=True)
    return _conclude(report["benchmarks"])


def project() -> Path:
    """Return the folder of the source tree; BenchError where the bench is installed without it."""
    for parent in Path(__file__).resolve().parents:
        if (parent / "benchmarks").is_dir():
            return parent
    raise BenchError("the folder 'benchmarks' is not there: run from the project's source tree")


def _conclude(reports: Mapping[str, Any]) -> int:
    """Print the last line; BenchError names what was missed or not measured."""
    rows = {
        f"{name}.{row}": entry
        for name, report in reports.items()
        for row, entry in (report or {}).get("rows", {}).items()
    }
    judged = sum(entry["reached"] is not None for entry in rows.values())
    below, broken = missed(rows), [name for name, report in reports.items() if report is None]
    wrong = [f"not measured: {', '.join(broken)}"] if broken else []
    wrong += [f"{len(below)} of {judged} targets missed: {', '.join(below)}"] if below else []
    if wrong:
        raise BenchError("; ".join(wrong))
    print(f"all {judged} targets met")
    return 0


def _write_figures(root: Path, reports: Mapping[str, Any]) -> None:
    rows = {name: report.get("rows", {}) for name, report in reports.items() if report}
    changed, stale = figures.rewrite(root, rows)
    print(f"figures rewritten in: {', '.join(str(p.relative_to(root)) for p in changed) or '-'}")
    if stale:
        print(f"figures as they were, not measured now: {', '.join(stale)}")


def _of_diagnosis(options: argparse.Namespace) -> list[str]:
    """Return what is handed on to the benchmark of diagnosis; BenchError where it does not run."""
    given = {name: getattr(options, name) for name in OF_DIAGNOSIS if getattr(options, name)}
    more = [f"--{name}" for name in ("full", "missing") if getattr(options, name)]
    for name, value in given.items():
        more += [f"--{name.replace('_', '-')}", *(value if isinstance(value, list) else [value])]
    if more and "diagnosis" not in options.names:
        raise BenchError(f"{more[0]} belongs to the benchmark 'diagnosis': steer bench diagnosis")
    return more


def _measure(program: Path, words: list[str]) -> dict[str, Any] | None:
    """Return a benchmark's numbers, None where it broke off or its status is not theirs."""
    with tempfile.TemporaryDirectory() as folder:
        file = Path(folder, "numbers.json")
        status = subprocess.call([sys.executable, str(program), "--json", str(file), *words])
        numbers = json.loads(file.read_text(encoding="utf-8")) if file.is_file() else {}
    whole = bool(numbers) and bool(status) == bool(missed(numbers.get("rows", {})))
    return numbers if whole else None


def _surroundings() -> dict[str, Any]:
    from steering_bringup.bags.run_metadata import libraries, machine, software

    return {"software": software(), "libraries": libraries(), **machine(), "cpus": os.cpu_count()}
