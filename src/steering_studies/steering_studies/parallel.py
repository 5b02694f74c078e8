"""Processes for studies; any concurrent.futures executor can stand in for their pool."""

from __future__ import annotations

import sys
from concurrent.futures import Executor, ProcessPoolExecutor
from contextlib import AbstractContextManager, nullcontext
from multiprocessing import get_context

from steering_core.errors import BenchError


def pool(jobs: int) -> AbstractContextManager[Executor | None]:
    """Return a pool of ``jobs`` processes, or None in its place for one; BenchError below one.

    Where the machine has no shared memory for them (/dev/shm is full or not there), all is computed
    in this process, which is said.
    """
    if jobs < 1:
        raise BenchError(f"--jobs must be at least 1, got {jobs}")
    if jobs == 1:
        return nullcontext()
    try:
        # Forked children would inherit threads of the numerical libraries in an unknown state.
        return ProcessPoolExecutor(jobs, get_context("spawn"))
    except (OSError, ImportError) as error:
        print(f"one process in place of {jobs}: {_without_memory(error)}", file=sys.stderr)
        return nullcontext()


def _without_memory(error: Exception) -> str:
    reason = (isinstance(error, OSError) and error.strerror) or str(error)
    return f"no shared memory for several (/dev/shm): {reason}"
