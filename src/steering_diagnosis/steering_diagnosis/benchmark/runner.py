"""Many cases: drawn, diagnosed and judged side by side; what is done is kept and not redone."""

from __future__ import annotations

import hashlib
import json
import time
from collections.abc import Callable, Iterable, Mapping, Sequence
from concurrent.futures import Executor, as_completed
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from steering_core.errors import BenchError
from steering_diagnosis.benchmark.bags import write_case
from steering_diagnosis.benchmark.cases import KINDS, draw_case, read_sealed
from steering_diagnosis.benchmark.methods import call, load_function
from steering_diagnosis.benchmark.scoring import Judgement, failed, judge
from steering_diagnosis.benchmark.truth.listed import LISTED
from steering_diagnosis.benchmark.truth.outside import OUTSIDE

SHARES: Mapping[str, float] = {
    "visible": 0.5,
    "pair": 0.15,
    "clean": 0.15,
    "outside": 0.1,
    "invisible": 0.1,
}
"""Of the kinds in a sample."""

FULL = 200
FULL_OF: Mapping[str, int] = {"outside": 60, "clean": 300}
"""Cases of a full run, and of these kinds so many: 1 in 300 and 5 % cannot be told from 20."""

STRIDE = 11
"""Between effects that follow each other; no divisor of their number, so that all come up."""

NOT_DRAWN = "not drawn"
"""Kind of a case whose seed gives no record that shows what it is to show; no rate counts it."""

CALIBRATION_SEED = 1_000_000
"""Clean records for calibration begin here; no benchmark's seed reaches it."""


@dataclass(frozen=True)
class Job:
    """One case to be done: kind, seed, and the effect to hide (None: drawn)."""

    kind: str
    seed: int
    effect: str | None = None

    @property
    def name(self) -> str:
        """Return the case's name, as in its sealed truth."""
        return f"{self.kind}-{self.seed:06d}"

    @property
    def bag(self) -> str:
        """Return the bag's name, which does not tell what is in it."""
        return "record-" + hashlib.sha256(self.name.encode()).hexdigest()[:10]


def plan(
    cases: int,
    seed: int,
    kinds: Sequence[str] = KINDS,
    least: Mapping[str, int] | None = None,
) -> list[Job]:
    """Return a sample of cases: shares as above, single effects in turn so that all come up.

    least: of these kinds at least so many, beyond ``cases``.
    """
    if not 0 <= seed <= 90:
        raise BenchError(f"--seed must be from 0 to 90, got {seed}")
    total = sum(SHARES[kind] for kind in kinds)
    shares = {kind: round(cases * SHARES[kind] / total) for kind in kinds}
    counts = {kind: max(1, n, (least or {}).get(kind, 0)) for kind, n in shares.items()}
    turns = {"visible": sorted({e.name for e in LISTED}), "outside": [e.name for e in OUTSIDE]}
    jobs = []
    for kind, count in counts.items():
        names = turns.get(kind, [None])
        jobs += [
            Job(kind, seed * 10_000 + i, names[(i * STRIDE + seed) % len(names)])
            for i in range(count)
        ]
    return jobs


def run_jobs(
    jobs: Sequence[Job],
    method: str,
    folder: Path,
    executor: Executor | None,
    done: Callable[[Judgement], None] = lambda _: None,
) -> list[Judgement]:
    """Return the judgements of all cases, in order."""
    load_function(method)
    found: dict[str, Judgement] = {}
    for judgement in _results(jobs, method, folder, executor):
        found[judgement.case] = judgement
        done(judgement)
    return [found[job.name] for job in jobs]


def _results(
    jobs: Sequence[Job], method: str, folder: Path, executor: Executor | None
) -> Iterable[Judgement]:
    if executor is None:
        yield from (solve(job, method, folder) for job in jobs)
        return
    for future in as_completed([executor.submit(solve, job, method, folder) for job in jobs]):
        yield future.result()


def solve(job: Job, method: str, folder: Path) -> Judgement:
    """Draw a case unless it is there, let the method diagnose it, judge, and keep the result.

    A case that cannot be drawn is told as a failure, and the others go on.
    """
    kept = folder / "results" / method.replace(":", ".") / f"{job.name}.json"
    if kept.is_file():
        content = json.loads(kept.read_text(encoding="utf-8"))["judgement"]
        return Judgement(
            **{k: _tuples(v) if isinstance(v, list) else v for k, v in content.items()}
        )
    try:
        bag, holdout = prepare(job, folder)
    except BenchError as error:
        return Judgement(job.name, NOT_DRAWN, (), NOT_DRAWN, failure=str(error))
    sealed = read_sealed(folder / "sealed" / f"{job.name}.json")
    started = time.perf_counter()
    report: dict[str, Any] = {}
    try:
        report = call(load_function(method), bag, holdout)
        judgement = judge(report, sealed, time.perf_counter() - started)
    except Exception as error:
        text = f"{type(error).__name__}: {error}"
        judgement = failed(sealed, text, time.perf_counter() - started)
    kept.parent.mkdir(parents=True, exist_ok=True)
    kept.write_text(json.dumps({"judgement": judgement.as_json(), "report": report}) + "\n")
    return judgement


def prepare(job: Job, folder: Path) -> tuple[Path, Path]:
    """Return the case's bag and its held-out one; the truth goes to a folder of its own."""
    bag, holdout = folder / "cases" / job.bag, folder / "cases" / f"{job.bag}-holdout"
    sealed = folder / "sealed" / f"{job.name}.json"
    if not (sealed.is_file() and bag.exists() and holdout.exists()):
        drawn = draw_case(job.kind, job.seed, job.effect, holdout=True)
        system = drawn.sealed.valve_system
        write_case(bag, drawn.signals, drawn.nominal, system, drawn.sealed.load)
        assert drawn.holdout is not None
        write_case(holdout, drawn.holdout, drawn.nominal, system, drawn.holdout_load)
        sealed.parent.mkdir(parents=True, exist_ok=True)
        drawn.sealed.write(sealed)
    return bag, holdout


def calibrate(
    count: int, statistic: str, folder: Path, executor: Executor | None, done: Callable[[], None]
) -> list[Any]:
    """Return a statistic (MODULE:FUNCTION of a bag's path) over clean records."""
    load_function(statistic)
    jobs = [Job("clean", CALIBRATION_SEED + i) for i in range(count)]
    values = []
    if executor is None:
        for job in jobs:
            values.append(_statistic(job, statistic, folder))
            done()
        return values
    for future in as_completed([executor.submit(_statistic, j, statistic, folder) for j in jobs]):
        values.append(future.result())
        done()
    return values


def _statistic(job: Job, statistic: str, folder: Path) -> Any:
    bag, _ = prepare(job, folder)
    return load_function(statistic)(bag)


def _tuples(value: Any) -> Any:
    return tuple(_tuples(v) for v in value) if isinstance(value, list) else value
