"""Watches the node processes of one run: phases, progress, failures, the end. Pure of ROS.

The supervisor sleeps in the operating system until a process says something or ends; it wakes
some ten times a second and does nothing else.
"""

from __future__ import annotations

import contextlib
import os
import signal
from collections.abc import Callable, Iterator
from dataclasses import dataclass, field
from multiprocessing.connection import Connection, wait
from time import monotonic
from types import FrameType
from typing import Any

import numpy as np

from steering_lockstep.outcome import Phase, Progress, RunError, RunResult
from steering_lockstep.settings import RunSettings
from steering_lockstep.stall import Report, culprit
from steering_lockstep.wire import NANOSECONDS_PER_TICK
from steering_lockstep.zygote import Zygote

BEAT = 0.1
REPORT_AGE = 0.5


@dataclass
class Child:
    """A node process: the nodes in it, its pid, our end of its connection, what it has said."""

    names: tuple[str, ...]
    pid: int
    connection: Connection
    missing: list[str] = field(default_factory=list)
    ready: bool = False
    finished: bool = False
    cpu_time: float = 0.0
    results: dict[str, dict[str, Any]] | None = None
    gone: bool = False


class Supervision:
    """One run's state. ``started_at``: the clock's tick 0 in ns of the monotonic clock, or 0."""

    def __init__(
        self,
        run: RunSettings,
        timeout: float,
        start_timeout: float,
        grace: float,
        on_progress: Callable[[Progress], None] | None,
    ) -> None:
        self.settings = run
        self.timeout = timeout
        self.start_timeout = start_timeout
        self.grace = grace
        self.on_progress = on_progress or (lambda progress: None)
        self.children: list[Child] = []
        self.error: RunError | None = None
        self.stopped_by: str | None = None
        self.hurry = False
        self.tick = 0
        self.phase: Phase = "starting"
        self.began = monotonic()
        self.moved = monotonic()
        self.heard = monotonic()
        self.started_at = 0
        self.reports: dict[str, tuple[float, Report]] = {}

    @contextlib.contextmanager
    def signals(self) -> Iterator[None]:
        """Take SIGINT and SIGTERM for the time of a run (in the main thread only)."""

        def note(number: int, frame: FrameType | None) -> None:
            self.hurry = self.stopped_by is not None
            self.stopped_by = signal.Signals(number).name

        before = {}
        try:
            for number in (signal.SIGINT, signal.SIGTERM):
                with contextlib.suppress(ValueError):
                    before[number] = signal.signal(number, note)
            yield
        finally:
            for number, handler in before.items():
                signal.signal(number, handler)

    def add(self, child: Child) -> None:
        """Watch one more process."""
        self.children.append(child)

    def run(self, zygote: Zygote) -> RunResult:
        """See the run through and return its outcome; every process is gone afterwards."""
        try:
            self._start()
            if not self._over():
                self._follow()
            self._close()
        finally:
            self._end(zygote)
        return self._result()

    def _start(self) -> None:
        """Wait until every node is matched in both directions, then let the clock go."""
        self._enter("starting")
        deadline = monotonic() + self.start_timeout
        while not self._over() and not all(child.ready for child in self.children):
            self._serve()
            if self.phase == "starting" and any(c.ready or c.missing for c in self.children):
                self._enter("matching")
            if monotonic() > deadline:
                self._fail_start()
        self.began = self.moved = monotonic()
        self._tell("go")

    def _follow(self) -> None:
        """Watch the ticks until all nodes have done their last one."""
        self._enter("running")
        while not self._over() and not all(child.finished for child in self.children):
            self._serve()
            if monotonic() - self.moved > self.timeout:
                self._fail_stalled()

    def _close(self) -> None:
        self._enter("closing")
        self._tell("stop" if self._over() else "close")
        self.heard = monotonic()
        while not self.hurry and not all(c.gone for c in self.children):
            self._serve()
            # Who has given its result has nothing to lose; the middleware may hang as it leaves.
            done = self._over() or all(c.results is not None for c in self.children)
            if monotonic() - self.heard > (self.grace if done else self.start_timeout):
                break

    def _end(self, zygote: Zygote) -> None:
        for child in self.children:
            if not child.gone:
                with contextlib.suppress(ProcessLookupError):
                    os.kill(child.pid, signal.SIGKILL)
            child.connection.close()
            code = zygote.reap(child.pid)
            if child.results is None and self.error is None and self.stopped_by is None:
                self.error = _died(child, code, self.tick)

    def _serve(self) -> None:
        """Take what the processes have to say; sleep at most one beat."""
        connections = {c.connection: c for c in self.children if not c.gone}
        if not connections:
            return
        for connection in wait(list(connections), BEAT):
            child = connections[connection]  # type: ignore[index]
            try:
                self._take(child, *child.connection.recv())
            except (EOFError, OSError):
                child.gone = True
        if self.phase == "running":
            self._show()

    def _take(self, child: Child, word: str, value: Any = None) -> None:
        if word == "matching":
            child.missing = value
        elif word == "ready":
            child.ready = True
        elif word == "progress":
            self._moved_to(value)
        elif word == "preparing":
            self.moved = monotonic()
        elif word == "reports":
            now = monotonic()
            self.reports.update({name: (now, report) for name, report in value.items()})
        elif word == "finished":
            child.finished = True
            child.cpu_time = value
            self.moved = monotonic()
        elif word == "error":
            self.error = self.error or value
        elif word == "result":
            child.results = value
            self.heard = monotonic()

    def _moved_to(self, tick: int) -> None:
        if tick > self.tick:
            self.tick = tick
            self.moved = monotonic()

    def _over(self) -> bool:
        """Whether the run cannot go on: an error, a signal, or a process that is gone."""
        lost = any(c.gone and c.results is None for c in self.children)
        return self.error is not None or self.stopped_by is not None or lost

    def _tell(self, word: str) -> None:
        for child in self.children:
            with contextlib.suppress(OSError):
                child.connection.send(word)

    def _enter(self, phase: Phase) -> None:
        self.phase = phase
        self._show()

    def _show(self) -> None:
        elapsed = monotonic() - self.began if self.phase in ("running", "closing") else 0.0
        self.on_progress(Progress(self.phase, self.tick, self.settings.ticks, elapsed))

    def _fail_start(self) -> None:
        late = next(child for child in self.children if not child.ready)
        what = "; ".join(late.missing) or "the process has not come up"
        text = f"not ready after {self.start_timeout:g} s: {what}"
        self.error = RunError("start", late.names[0], None, None, text)

    def _fail_stalled(self) -> None:
        fresh = monotonic() - REPORT_AGE
        reports = {name: report for name, (when, report) in self.reports.items() if when > fresh}
        found = culprit(reports, self.settings.graph)
        tick = self.tick if found.tick is None else found.tick
        owed = "" if found.topic is None else f", topic {found.topic}"
        text = f"node '{found.node}'{owed}, tick {tick}: nothing for {self.timeout:g} s; "
        self.error = RunError("timeout", found.node, found.topic, tick, text + found.reason)

    def _result(self) -> RunResult:
        results: dict[str, dict[str, Any]] = {}
        for child in self.children:
            results.update(child.results or {})
        outcome = RunResult(
            ok=self.error is None and self.stopped_by is None,
            error=self.error,
            stopped_by=self.stopped_by,
            node_results=results,
            ticks=self.tick,
            cpu_time=sum(child.cpu_time for child in self.children),
        )
        for name, result in results.items():
            outcome.counts[name] = result.pop("published", {})
            outcome.lost.update(result.pop("lost", {}))
        self._clock(outcome, results.get(self.settings.graph.clock.name, {}))
        return outcome

    def _clock(self, outcome: RunResult, result: dict[str, Any]) -> None:
        self.started_at = result.pop("started_at", 0)
        ended = result.pop("ended_at", 0)
        outcome.ticks = result.pop("ticks", self.tick)
        if self.started_at:
            # A run that was broken off has no end but its last sign of life.
            last = ended * 1e-9 if ended else self.moved
            outcome.wall_time = max(last - self.started_at * 1e-9, 0.0)
        lateness = result.pop("lateness", np.zeros(0))[: outcome.ticks]
        if len(lateness):
            outcome.latency = latency(lateness)


def latency(lateness: np.ndarray) -> dict[str, float]:
    """Return percentiles [s] of the time from a tick's due time to its last command [ns]."""
    return {
        "p50": float(np.percentile(lateness, 50.0)) * 1e-9,
        "p99": float(np.percentile(lateness, 99.0)) * 1e-9,
        "max": float(lateness.max()) * 1e-9,
        "overruns": int(np.sum(lateness > NANOSECONDS_PER_TICK)),
        "ticks": len(lateness),
    }


def _died(child: Child, code: int, tick: int) -> RunError:
    how = f"killed by {signal.Signals(-code).name}" if code < 0 else f"exit status {code}"
    names = ", ".join(f"'{name}'" for name in child.names)
    text = f"the process of {names} ended in mid-run ({how}) about tick {tick}"
    return RunError("died", child.names[0], None, tick, text)
