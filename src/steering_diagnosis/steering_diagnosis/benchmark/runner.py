"""Many cases: drawn, diagnosed and judged side by side; what is done is kept and not redone."""

from __future__ import annotations

import hashlib
import json
import time
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from concurrent.futures import Executor, as_completed
from dataclasses import dataclass, replace
from functools import lru_cache
from itertools import groupby
from pathlib import Path
from typing import Any

from steering_core.errors import BenchError
from steering_diagnosis.benchmark.cases import KINDS, Drawn, draw_case, read_sealed, sealed_behind
from steering_diagnosis.benchmark.doors.door import ALL_IN_A_BAG, Door
from steering_diagnosis.benchmark.doors.write import Paths, paths, write_mapping, write_through
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


Doors = Callable[[int], Door]
"""A case's seed to the door through which it comes in."""


@dataclass(frozen=True)
class Job:
    """One case to be done: kind, seed, the effect to hide (None: drawn), and its door."""

    kind: str
    seed: int
    effect: str | None = None
    door: Door = ALL_IN_A_BAG

    @property
    def name(self) -> str:
        """Return the specimen's name, as in its sealed truth."""
        return f"{self.kind}-{self.seed:06d}"

    @property
    def case(self) -> str:
        """Return the case's name: the specimen and its door, where that is no bag with all."""
        return ".".join(filter(None, [self.name, self.door.label]))

    @property
    def record(self) -> str:
        """Return the record's name, which does not tell what is in it."""
        digest = hashlib.sha256(self.name.encode()).hexdigest()[:10]
        return "-".join(filter(None, ["record", digest, self.door.label.replace(".", "-")]))


def plan(
    cases: int,
    seed: int,
    kinds: Sequence[str] = KINDS,
    least: Mapping[str, int] | None = None,
    doors: Doors = lambda _: ALL_IN_A_BAG,
) -> list[Job]:
    """Return a sample of cases: shares as above, single effects in turn so that all come up.

    least: of these kinds at least so many, beyond ``cases``. doors: the door of each, by its seed.
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
        for i in range(count):
            number = seed * 10_000 + i
            effect = names[(i * STRIDE + seed) % len(names)]
            jobs.append(Job(kind, number, effect, doors(number)))
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
    for judgements in _results(jobs, method, folder, executor):
        for judgement in judgements:
            found[judgement.case] = judgement
            done(judgement)
    return [found[job.case] for job in jobs]


def _results(
    jobs: Sequence[Job], method: str, folder: Path, executor: Executor | None
) -> Iterable[list[Judgement]]:
    """Return the judgements; the doors of one specimen follow each other in one process.

    Kinds and effects come mixed, so that a run that is broken off is a sample of the whole.
    """
    specimens = [list(group) for _, group in groupby(jobs, lambda job: job.name)]
    specimens.sort(key=lambda group: hashlib.sha256(group[0].name.encode()).digest())
    if executor is None:
        yield from (_solve_all(group, method, folder) for group in specimens)
        return
    waiting = [executor.submit(_solve_all, group, method, folder) for group in specimens]
    for future in as_completed(waiting):
        yield future.result()


def _solve_all(jobs: Sequence[Job], method: str, folder: Path) -> list[Judgement]:
    return [solve(job, method, folder) for job in jobs]


def solve(job: Job, method: str, folder: Path) -> Judgement:
    """Draw a case unless it is there, let the method diagnose it, judge, and keep the result.

    A case that cannot be drawn is told as a failure, and so is any error; the others go on.
    """
    kept = _results_of(folder, method) / f"{job.case}.json"
    if kept.is_file():
        return _kept(kept, _sealed(job, folder))
    try:
        at = prepare(job, folder)
    except BenchError as error:
        return Judgement(job.case, NOT_DRAWN, (), NOT_DRAWN, failure=str(error))
    except Exception as error:
        text = f"not written: {type(error).__name__}: {error}"
        return Judgement(job.case, job.kind, (), "failed", failure=text)
    sealed = read_sealed(_sealed(job, folder))
    started = time.perf_counter()
    report: dict[str, Any] = {}
    try:
        report = call(load_function(method), at)
        judgement = judge(report, sealed, time.perf_counter() - started)
    except Exception as error:
        text = f"{type(error).__name__}: {error}"
        judgement = failed(sealed, text, time.perf_counter() - started)
    kept.parent.mkdir(parents=True, exist_ok=True)
    kept.write_text(json.dumps({"judgement": judgement.as_json(), "report": report}) + "\n")
    return judgement


def kept_results(folder: Path, method: str) -> Iterator[tuple[Judgement, dict[str, Any]]]:
    """Yield the judgement and the report of each result that ``folder`` of records keeps."""
    for file in sorted(_results_of(folder, method).glob("*.json")):
        report = json.loads(file.read_text(encoding="utf-8"))["report"]
        yield _kept(file, folder / "sealed" / file.name), report


def _results_of(folder: Path, method: str) -> Path:
    return folder / "results" / method.replace(":", ".")


def _kept(file: Path, sealed: Path) -> Judgement:
    """Return the judgement of a kept result: of its report anew, as rules of judging may change."""
    kept = json.loads(file.read_text(encoding="utf-8"))
    before = kept["judgement"]
    if kept["report"] and sealed.is_file():
        return judge(kept["report"], read_sealed(sealed), before["seconds"])
    return Judgement(**{k: _tuples(v) if isinstance(v, list) else v for k, v in before.items()})


def prepare(job: Job, folder: Path) -> Paths:
    """Return where the case lies, which is written unless it is there; the truth lies apart."""
    at, sealed = paths(job.door, folder / "cases", job.record), _sealed(job, folder)
    if not (sealed.is_file() and at.there()):
        drawn = _drawn(job.kind, job.seed, job.effect)
        system, about = drawn.sealed.valve_system, drawn.sealed
        write_through(job.door, at.record, drawn.signals, drawn.nominal, system, about.load)
        assert drawn.holdout is not None
        load = drawn.holdout_load
        write_through(job.door, at.holdout, drawn.holdout, drawn.nominal, system, load)
        if at.mapping is not None:
            write_mapping(job.door, at.mapping, drawn.signals, system)
        sealed.parent.mkdir(parents=True, exist_ok=True)
        replace(sealed_behind(drawn, job.door), case=job.case).write(sealed)
    return at


def _sealed(job: Job, folder: Path) -> Path:
    return folder / "sealed" / f"{job.case}.json"


def _drawn(kind: str, seed: int, effect: str | None) -> Drawn:
    """Return a specimen with its records; BenchError where it cannot be drawn."""
    found = _attempt(kind, seed, effect)
    if isinstance(found, BenchError):
        raise found
    return found


@lru_cache(maxsize=1)
def _attempt(kind: str, seed: int, effect: str | None) -> Drawn | BenchError:
    """Return a specimen or why there is none; the last is remembered for its other doors."""
    try:
        return draw_case(kind, seed, effect, holdout=True)
    except BenchError as error:
        return error


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
    return load_function(statistic)(prepare(job, folder).record)


def _tuples(value: Any) -> Any:
    return tuple(_tuples(v) for v in value) if isinstance(value, list) else value
