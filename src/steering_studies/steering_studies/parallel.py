"""Processes for studies; any concurrent.futures executor can stand in for their pool."""

from __future__ import annotations

from concurrent.futures import Executor, ProcessPoolExecutor
from contextlib import AbstractContextManager, nullcontext
from multiprocessing import get_context

from steering_core.errors import BenchError


def pool(jobs: int) -> AbstractContextManager[Executor | None]:
    """Return a pool of ``jobs`` processes, or None in its place for one; BenchError below one."""
    if jobs < 1:
        raise BenchError(f"--jobs must be at least 1, got {jobs}")
    # Forked children would inherit threads of the numerical libraries in an unknown state.
    return ProcessPoolExecutor(jobs, get_context("spawn")) if jobs > 1 else nullcontext()
