"""Processes and a progress bar for studies; any concurrent.futures executor can stand in."""

from __future__ import annotations

import sys
from concurrent.futures import Executor, ProcessPoolExecutor
from contextlib import AbstractContextManager, nullcontext
from multiprocessing import get_context
from types import TracebackType

from steering_core.errors import BenchError


class Steps:
    """Progress by the share done (0 to 1) and what is being done; nothing where no terminal is."""

    def __init__(self, title: str) -> None:
        self._bar = None
        if sys.stdout.isatty() and sys.stderr.isatty():
            from tqdm import tqdm

            shown = "{desc} |{bar:30}| {percentage:3.0f} %{postfix}"
            self._bar = tqdm(total=1.0, desc=title, bar_format=shown, leave=False)

    def __call__(self, share: float, what: str = "") -> None:
        """Show that ``share`` of the work is done."""
        if self._bar is not None:
            self._bar.set_postfix_str(what, False)
            self._bar.n = min(share, 1.0)
            self._bar.refresh()

    def __enter__(self) -> Steps:
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        if self._bar is not None:
            self._bar.close()


def pool(jobs: int) -> AbstractContextManager[Executor | None]:
    """Return a pool of ``jobs`` processes, or None in its place for one; BenchError below one."""
    if jobs < 1:
        raise BenchError(f"--jobs must be at least 1, got {jobs}")
    # Forked children would inherit threads of the numerical libraries in an unknown state.
    return ProcessPoolExecutor(jobs, get_context("spawn")) if jobs > 1 else nullcontext()
