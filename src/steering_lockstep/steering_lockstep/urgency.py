"""A process in which wall time counts: no pauses for garbage, and ahead of others if permitted."""

from __future__ import annotations

import gc
import os
from collections.abc import Iterable
from contextlib import suppress
from pathlib import Path

from steering_lockstep.graph import RECORDER_KIND

PRIORITY, RECORDER_PRIORITY = 20, 10
"""A recorder comes after the loop, but before everything else: it shares locks with the loop."""


def hurry(kinds: Iterable[str]) -> None:
    """Prepare a process with nodes of ``kinds``.

    The collector of cyclic garbage stays off in the loop: the nodes make none, and it would stop
    them for milliseconds. Without the permission for real-time scheduling that part is left out.
    """
    records = set(kinds) == {RECORDER_KIND}
    without_pauses()
    if records:
        gc.enable()
    hasten(os.getpid(), RECORDER_PRIORITY if records else PRIORITY)


def without_pauses() -> None:
    """Switch the collector of cyclic garbage off, for a loop that makes none."""
    gc.collect()
    gc.freeze()
    gc.disable()


def hasten(pid: int, priority: int) -> None:
    """Give all threads of a process a real-time ``priority``, where this is permitted."""
    with suppress(OSError):
        for thread in Path(f"/proc/{pid}/task").iterdir():
            os.sched_setscheduler(int(thread.name), os.SCHED_FIFO, os.sched_param(priority))
