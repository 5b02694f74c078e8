"""The engine's entry: from a replay to what is wrong with its model."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import Executor
from contextlib import contextmanager

import numpy as np

from steering_core.errors import BenchError
from steering_diagnosis.engine.catalogue import Catalogue, catalogue
from steering_diagnosis.engine.conclude import conclude
from steering_diagnosis.engine.evaluate import Evaluator
from steering_diagnosis.engine.evidence import HeldOut
from steering_diagnosis.engine.failures import NUMERICAL, GivenUpError, reason
from steering_diagnosis.engine.findings import Findings
from steering_diagnosis.engine.fit import Problem, nominal
from steering_diagnosis.engine.model import Replay
from steering_diagnosis.engine.sampling import blocks, held_out, moments, sampling
from steering_diagnosis.engine.search import Search
from steering_diagnosis.engine.settings import Settings
from steering_diagnosis.engine.templates import Template, nuisance_columns, templates

Progress = Callable[[float, str], None]
"""Called with the share done (0 to 1) and what is being done."""


def diagnose(
    fit: Replay,
    holdout: Replay | None = None,
    *,
    executor: Executor | None = None,
    progress: Progress | None = None,
    settings: Settings | None = None,
) -> Findings:
    """Find the causes of the replay's error, or say what cannot be explained.

    holdout: the same model bound to another record; without it, blocks of the record are held out.
    executor: where replays run; replays are pickled to it. BenchError: too few samples, or the
    nominal model cannot follow the record. A model with causes that cannot is told and left out.
    """
    tell = progress or (lambda share, text: None)
    search, block = begin(fit, holdout, executor=executor, progress=tell, settings=settings)
    with _nominal():
        findings = _concluded(search, block)
    tell(1.0, "done")
    return findings


def _concluded(search: Search, block: np.ndarray) -> Findings:
    """Return what the best model says that can be judged from end to end."""
    while True:
        try:
            best = search.best()
            with search.judging(best.names):
                return conclude(search, best, block)
        except GivenUpError as error:
            search.begin_without(error)


@contextmanager
def _nominal() -> Iterator[None]:
    """Say of what no model with causes is to blame for that the nominal one fails."""
    try:
        yield
    except NUMERICAL as error:
        raise BenchError(f"the nominal model cannot be judged: {reason(error)}") from error


def begin(
    fit: Replay,
    holdout: Replay | None = None,
    *,
    executor: Executor | None = None,
    progress: Progress | None = None,
    settings: Settings | None = None,
) -> tuple[Search, np.ndarray]:
    """Return the search that a diagnosis begins with, and the block of each sample, (n,).

    The nominal model is fitted and the catalogue's templates are there. As for ``diagnose``.
    """
    settings = settings or Settings()
    tell = progress or (lambda share, text: None)
    grid = sampling(_length(fit), fit.period_s, settings)
    book = catalogue(fit)
    expected = _expected_calls(book, settings)
    runs = Evaluator(
        fit, grid, executor, lambda calls: tell(min(0.98, calls / expected), "replaying")
    )
    base = runs.base
    nuisance = nuisance_columns(runs, book, base)
    trials, failed = templates(runs, book, base, nuisance, settings.shape_grid)
    block = blocks(len(base), grid.step_s, settings)
    out = held_out(block, settings.held_out_every) if holdout is None else np.zeros(len(base), bool)
    valid = runs.valid
    problem = Problem(
        runs=runs,
        book=book,
        settings=settings,
        nuisance=np.where(valid[..., None], nuisance, 0.0),
        valid=valid,
        training=valid & ~out[:, None],
        floor=resolution(base, nuisance, trials, settings),
    )
    held = (
        HeldOut(None, valid, block, valid & out[:, None], moments(len(base), grid.step_s, settings))
        if holdout is None
        else _second_record(holdout, settings, executor)
    )
    with _nominal():
        return Search(
            problem,
            held,
            trials,
            nominal(problem),
            lambda name: tell(_share(runs, expected), name),
            failed={frozenset({name}): why for name, why in failed.items()},
        ), block


def resolution(
    base: np.ndarray, nuisance: np.ndarray, trials: Sequence[Template], settings: Settings
) -> np.ndarray:
    """Return the error of each output that is never judged, (outputs,).

    A share of what the tolerances scatter: without it a noise-free record would resolve the
    difference of two solvers. Where no tolerance shows, a share of the largest hypothesis.
    """
    scatter = np.sqrt(np.nanmean(np.sum(nuisance**2, axis=-1), axis=0))
    largest = np.max(
        [np.sqrt(np.nanmean(np.sum(t.columns**2, axis=-1), axis=0)) for t in trials]
        or [np.zeros(base.shape[1])],
        axis=0,
    )
    floor = settings.resolution * np.where(scatter > 0.0, scatter, 0.1 * largest)
    return np.where(floor > 0.0, floor, 1e-6 * np.sqrt(np.nanmean(base**2, axis=0)) + 1e-300)


def _second_record(replay: Replay, settings: Settings, executor: Executor | None) -> HeldOut:
    grid = sampling(_length(replay), replay.period_s, settings)
    runs = Evaluator(replay, grid, executor)
    valid = runs.valid
    n = len(valid)
    block, moment = blocks(n, grid.step_s, settings), moments(n, grid.step_s, settings)
    return HeldOut(runs, valid, block, valid, moment)


def _length(replay: Replay) -> int:
    return len(next(iter(replay.states().values())))


def _expected_calls(book: Catalogue, settings: Settings) -> int:
    parameters = sum(len(h.parameters) for h in book.hypotheses.values())
    return 40 + len(book.nuisances) + 2 * parameters + 8 * settings.refitted


def _share(runs: Evaluator, expected: int) -> float:
    return min(0.98, runs.calls / expected)
