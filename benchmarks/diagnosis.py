"""The sealed benchmark of diagnosis: hidden effects, rates against their targets.

A case is a bag with one hidden effect, two, none, one too small to be seen, or something that the
catalogue does not have; docs/diagnosis_benchmark.md says how they are made and judged.
"""

from __future__ import annotations

import argparse
import json
import re
import sys
import tempfile
from collections.abc import Sequence
from dataclasses import asdict, replace
from functools import partial
from pathlib import Path
from typing import Any

from steering_bringup.benchmarking.program import Measured, finish
from steering_bringup.benchmarking.registry import BENCHMARKS
from steering_bringup.benchmarking.rows import Benchmark, Row
from steering_core.errors import BenchError
from steering_core.naming import unknown
from steering_diagnosis.benchmark import missing
from steering_diagnosis.benchmark.by_door import HEAD, by_door, cells
from steering_diagnosis.benchmark.cases import KINDS
from steering_diagnosis.benchmark.changes import changes
from steering_diagnosis.benchmark.doors.channel_sets import LACKABLE, NONE
from steering_diagnosis.benchmark.doors.door import DRAWN, draw_door
from steering_diagnosis.benchmark.doors.door import KINDS as KINDS_OF_DOOR
from steering_diagnosis.benchmark.methods import NAMED
from steering_diagnosis.benchmark.missing import costs, without_each
from steering_diagnosis.benchmark.page import benchmark_page, rate_row
from steering_diagnosis.benchmark.runner import (
    FULL,
    FULL_OF,
    NOT_DRAWN,
    Job,
    calibrate,
    plan,
    run_jobs,
)
from steering_diagnosis.benchmark.scoring import Judgement, Rate, confusion, rates
from steering_diagnosis.running import Steps, pool
from steering_diagnosis.steering.clean_gains import largest

SAMPLE = 20
GAINS = "steering_diagnosis.steering.clean_gains:gains_of"


def parser() -> argparse.ArgumentParser:
    """Return the options."""
    made = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    add = made.add_argument
    add("--cases", type=int, default=SAMPLE, metavar="N", help=f"cases (default: {SAMPLE})")
    add(
        "--full",
        action="store_true",
        help=f"{FULL} cases; of the clean {FULL_OF['clean']}, outside {FULL_OF['outside']}",
    )
    add("--kinds", nargs="+", default=list(KINDS), metavar="KIND", help=f"of {', '.join(KINDS)}")
    add("--seed", type=int, default=0, metavar="S", help="other records for another seed")
    add("--records", type=Path, metavar="DIR", help="keep bags, truths and results; goes on there")
    add("--method", default="engine", help=f"{', '.join(NAMED)} or MODULE:FUNCTION (bag to report)")
    add("--jobs", type=int, default=2, metavar="N", help="processes (default: 2)")
    add("--calibrate", metavar="MODULE:FUNCTION", help="distribution of a statistic (bag to number)"
        " over N clean records of seeds that no benchmark uses")  # fmt: skip
    add("--clean-gains", type=Path, metavar="FILE", help="write what N clean records gain by wrong"
        " causes: the engine's own calibration")  # fmt: skip
    add("--doors", default=DRAWN, metavar="DOOR", help=f"{', '.join((DRAWN, *KINDS_OF_DOOR))}: each"
        f" case draws its own (default: {DRAWN}), or all come in through one")  # fmt: skip
    add("--without", nargs="+", metavar="GROUP", help="these channels are not measured, instead of"
        f" those drawn: {', '.join((NONE, *LACKABLE))}")  # fmt: skip
    add("--missing", action="store_true", help="N specimens, each with all channels and without"
        " some: what a missing channel costs")  # fmt: skip
    add("--diff", type=Path, metavar="DIR", help="only tell what differs between the results kept"
        " in DIR and in --records: verdicts, names, sizes")  # fmt: skip
    add("--json", type=Path, metavar="FILE", help="write the numbers here too")
    add("--quick", action="store_true", help="the smallest size, seconds long")
    add(
        "--page", type=Path, metavar="FILE", help="write the HTML page here (default: in --records)"
    )
    return made


def main() -> int:
    """Run, print, write."""
    options = parser()
    if options.parse_known_args()[0].quick:
        options.set_defaults(**BENCHMARKS["diagnosis"].quick)
    asked = options.parse_args()
    try:
        for kind in asked.kinds:
            if kind not in KINDS:
                raise BenchError(unknown("kind of case", kind, KINDS))
        if asked.cases < 1:
            raise BenchError(f"--cases must be at least 1, got {asked.cases}")
        if asked.diff is not None:
            return _diff(asked)
        if asked.records is not None:
            return _run(asked, asked.records)
        with tempfile.TemporaryDirectory() as folder:
            return _run(asked, Path(folder))
    except BenchError as error:
        print(f"diagnosis: {error}", file=sys.stderr)
        return 1


def _diff(asked: argparse.Namespace) -> int:
    """Tell what differs between two folders of results; nothing is diagnosed."""
    if asked.records is None:
        raise BenchError("--diff DIR compares with the results in --records DIR: name both")
    found = list(changes(asked.diff, asked.records, asked.method))
    for case, what in found:
        print(f"{case}: {what}")
    _write(asked.json, {"changes": [{"case": case, "what": what} for case, what in found]})
    return 0


def _run(asked: argparse.Namespace, folder: Path) -> int:
    if asked.clean_gains:
        return _clean_gains(asked, folder)
    if asked.calibrate:
        return _calibrate(asked, folder)
    cases, least = (FULL, FULL_OF) if asked.full else (asked.cases, None)
    doors = partial(draw_door, kind=asked.doors, lacking=asked.without)
    jobs = plan(cases, asked.seed, asked.kinds, least, doors)
    if asked.missing:
        return _missing(asked, _judged(asked, without_each(jobs), folder))
    judgements = _judged(asked, jobs, folder)
    numbers = report(asked.method, judgements)
    for line in rates(judgements):
        what, value, interval, counted, target = rate_row(line)
        print(f"{what:48}{value:>8}  [{interval:13}] of {counted:>3}   target {target}")
    _print_table((HEAD, *(cells(row) for row in by_door(judgements))))
    failures = _tell_failures(judgements)
    page = asked.page or (asked.records / "benchmark.html" if asked.records else None)
    if page is not None:
        benchmark_page(asked.method, rates(judgements), confusion(judgements), judgements).write(
            page
        )
        print(f"page: {page}")
    errors = [j for j in failures if j.kind != NOT_DRAWN]
    benchmark, values = as_rows(rates(judgements), len(errors))
    return finish(benchmark, Measured(values, numbers), asked.json, asked.quick)


def as_rows(found: list[Rate], failed: int) -> tuple[Benchmark, dict[str, float | None]]:
    """Return the rates as the rows of this benchmark, and their values."""
    rows = [Row("failed", "cases that failed", at_most=0.0, digits=0)]
    values: dict[str, float | None] = {"failed": failed}
    for rate in found:
        bound = {"at_least" if rate.at_least else "at_most": rate.target}
        name = "_".join(re.findall(r"[a-z0-9]+", rate.what))
        rows.append(Row(name, rate.what, digits=3, **bound))
        values[name] = rate.value
    return replace(BENCHMARKS["diagnosis"], rows=tuple(rows)), values


def _judged(asked: argparse.Namespace, jobs: list[Job], folder: Path) -> list[Judgement]:
    """Return the judgements of all jobs, with a bar."""
    with Steps("diagnosis") as bar, pool(asked.jobs) as executor:
        count = 0

        def done(judgement: Judgement) -> None:
            nonlocal count
            count += 1
            bar(count / len(jobs), f"{count} of {len(jobs)}: {judgement.case}")

        return run_jobs(jobs, asked.method, folder, executor, done)


def _missing(asked: argparse.Namespace, judgements: list[Judgement]) -> int:
    """Tell what each missing channel costs."""
    found = costs(judgements)
    _print_table((missing.HEAD, *(missing.cells(cost) for cost in found)))
    _tell_failures(judgements)
    lines = [judgement.as_json() for judgement in judgements]
    _write(asked.json, {"costs": [asdict(cost) for cost in found], "judgements": lines})
    return 0


def _tell_failures(judgements: list[Judgement]) -> list[Judgement]:
    failures = [j for j in judgements if j.failure]
    for j in failures:
        what = "" if j.kind == NOT_DRAWN else "the method failed: "
        print(f"{j.case}: {what}{j.failure}")
    return failures


def _print_table(lines: Sequence[Sequence[str]]) -> None:
    print()
    for line in lines:
        print(f"{line[0]:32}" + "".join(f"{cell:>13}" for cell in line[1:]))
    print()


def report(method: str, judgements: list[Judgement]) -> dict[str, Any]:
    """Return everything as plain data."""
    found = rates(judgements)
    return {
        "method": method,
        "cases": len(judgements),
        "rates": [asdict(rate) | {"reached": rate.reached} for rate in found],
        "by_door": [asdict(row) for row in by_door(judgements)],
        "confusion": confusion(judgements),
        "judgements": [judgement.as_json() for judgement in judgements],
    }


def _over_clean(asked: argparse.Namespace, statistic: str, folder: Path) -> list[Any]:
    """Return a statistic over clean records, with a bar."""
    with Steps("calibrating") as bar, pool(asked.jobs) as executor:
        count = 0

        def done() -> None:
            nonlocal count
            count += 1
            bar(count / asked.cases, f"{count} of {asked.cases}")

        return calibrate(asked.cases, statistic, folder, executor, done)


def _clean_gains(asked: argparse.Namespace, folder: Path) -> int:
    found = largest(_over_clean(asked, GAINS, folder))
    for system, gains in found["gains"].items():
        print(f"{system}, {found['records'][system]} records")
        for name, gain in gains.items():
            print(f"  {name:50} {gain:6.2f}")
    _write(asked.clean_gains, found)
    _write(asked.json, found)
    return 0


def _calibrate(asked: argparse.Namespace, folder: Path) -> int:
    import numpy as np

    values = [float(value) for value in _over_clean(asked, asked.calibrate, folder)]
    levels = (0.5, 0.9, 0.95, 0.99, 0.997, 1.0)
    quantiles = {str(level): float(np.quantile(values, level)) for level in levels}
    for level, value in quantiles.items():
        print(f"quantile {level:>6}: {value:.6g}")
    _write(
        asked.json, {"statistic": asked.calibrate, "values": sorted(values), "quantiles": quantiles}
    )
    return 0


def _write(file: Path | None, numbers: dict[str, Any]) -> None:
    if file is not None:
        file.parent.mkdir(parents=True, exist_ok=True)
        file.write_text(json.dumps(numbers, indent=1) + "\n", encoding="utf-8")


if __name__ == "__main__":
    sys.exit(main())
