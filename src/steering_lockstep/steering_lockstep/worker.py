"""The program of a node process: build the nodes, match, run, close, and tell the supervisor.

Messages to the supervisor: ("matching", [what is missing]), ("ready",), ("progress", tick),
("preparing",),
("reports", {node: Report}), ("finished", CPU seconds since "go"),
("error", RunError), ("result", {node: result}).
From the supervisor: "go", "stop", "close". A supervisor that goes away means "stop".
"""

from __future__ import annotations

import os
import signal
import threading
from dataclasses import replace
from multiprocessing.connection import Connection
from pkgutil import resolve_name
from time import monotonic, process_time
from typing import Any

import rclpy
from rclpy.context import Context

from steering_lockstep.clock_node import ClockNode
from steering_lockstep.errors import LockstepError
from steering_lockstep.in_process import introduce
from steering_lockstep.kinds import factory
from steering_lockstep.node import LockstepNode
from steering_lockstep.outcome import RunError
from steering_lockstep.spinner import Spinner
from steering_lockstep.standalone import Others
from steering_lockstep.urgency import hurry
from steering_lockstep.worker_job import Job

MATCHING_STEP = 0.005
MATCHING_REPORT = 0.25
BEAT = 0.1
TERMINATION = {signal.SIGTERM}


class Link:
    """The connection to the supervisor; sending is safe from two threads."""

    def __init__(self, connection: Connection) -> None:
        self._connection = connection
        self._lock = threading.Lock()
        self.closing = threading.Event()

    def send(self, *message: Any) -> None:
        """Send a message; a supervisor that is gone is noticed by ``receive``."""
        with self._lock:
            try:
                self._connection.send(message)
            except OSError:
                self.closing.set()

    def receive(self, seconds: float) -> str | None:
        """Return the supervisor's next word, None after ``seconds``, "stop" if it is gone.

        A SIGTERM is taken here as the word "terminate": in a handler it would wait for the main
        thread, which is somewhere in the middleware.
        """
        if signal.sigtimedwait(TERMINATION, 0) is not None:
            return "terminate"
        try:
            return self._connection.recv() if self._connection.poll(seconds) else None
        except (EOFError, OSError):
            return "stop"


def work(connection: Connection, job: Job) -> None:
    """Run ``job`` to its end and report on ``connection``."""
    signal.pthread_sigmask(signal.SIG_BLOCK, TERMINATION)
    link = Link(connection)
    os.environ.update(job.environment)
    context = Context()
    rclpy.init(context=context, domain_id=job.domain)
    nodes: list[LockstepNode] = []
    spinner: Spinner | None = None
    try:
        nodes = _build(link, context, job)
        if len(nodes) == len(job.names):
            spinner = Spinner(context, nodes, _executor(job, context))
            _run(link, spinner, job)
        _close(link, nodes)
    finally:
        if spinner is not None:
            spinner.close()
        for node in nodes:
            node.destroy_node()
        context.try_shutdown()


def _build(link: Link, context: Context, job: Job) -> list[LockstepNode]:
    nodes: list[LockstepNode] = []
    run = replace(job.run, together=frozenset(job.names)) if job.run.urgent else job.run
    for name in job.names:
        spec = run.graph.node(name)
        try:
            make = factory(spec.kind)
            nodes.append(make(context, spec, run, dict(job.parameters.get(name, {}))))
        except Exception as error:
            text = f"node '{name}' cannot start: {error}"
            link.send("error", RunError("start", name, None, None, text))
            return nodes
    if run.together:
        introduce(nodes, run)
    return nodes


def _executor(job: Job, context: Context) -> Any:
    """Return the executor named by "module:function", for comparisons; None is our own."""
    if job.executor is None:
        return None
    return resolve_name(job.executor)(context=context)


def _run(link: Link, spinner: Spinner, job: Job) -> None:
    if not _match(link, spinner, job):
        return
    if spinner.nodes[0].run.urgent:
        hurry([node.spec.kind for node in spinner.nodes])
    began = process_time()
    threading.Thread(target=_watch, args=(link, spinner), daemon=True).start()
    spinner.run()
    if spinner.error is not None:
        link.send("error", _run_error(spinner.error))
    elif spinner.finished:
        link.send("finished", process_time() - began)
    link.closing.wait()


def _match(link: Link, spinner: Spinner, job: Job) -> bool:
    """Wait until all endpoints are matched in both directions; False if told to stop.

    Nodes outside know of each other by their word alone, and of ours by ours.
    """
    others = Others(spinner.nodes[0], job.run.graph) if job.external else None
    due = monotonic() + MATCHING_REPORT
    told = False
    while missing := spinner.unmatched() or _not_heard_of(others, job):
        if others is not None and not told and not spinner.unmatched():
            others.tell(job.names)
            told = True
        if (word := link.receive(0.0)) is not None:
            _heed(link, spinner, word)
            return False
        if monotonic() >= due:
            link.send("matching", missing)
            due = monotonic() + MATCHING_REPORT
        spinner.spin_for(MATCHING_STEP)
    if others is not None and not told:
        others.tell(job.names)
    link.send("ready")
    return True


def _not_heard_of(others: Others | None, job: Job) -> list[str]:
    """Return which of the nodes outside have not said that they are ready."""
    missing = [] if others is None else [n for n in others.missing if n in job.external]
    return [f"node '{name}', which is started elsewhere, has not come up" for name in missing]


def _watch(link: Link, spinner: Spinner) -> None:
    """Pass on the supervisor's words, and tell it of progress, or who waits for what."""
    clock = next((n for n in spinner.nodes if isinstance(n, ClockNode)), None)
    before: tuple[int, ...] = ()
    while not link.closing.is_set():
        word = link.receive(BEAT)
        if word is not None:
            _heed(link, spinner, word)
        ticks = tuple(node.barrier.tick for node in spinner.nodes)
        if clock is not None and clock.preparing:
            link.send("preparing")
        elif ticks == before:
            link.send("reports", {node.spec.name: node.report() for node in spinner.nodes})
        elif clock is not None:
            link.send("progress", clock.barrier.tick)
        before = ticks


def _heed(link: Link, spinner: Spinner, word: str) -> None:
    if word == "go":
        spinner.start()
        return
    if word == "terminate":
        names = ", ".join(f"'{node.spec.name}'" for node in spinner.nodes)
        text = f"the process of {names} was told to end (SIGTERM)"
        link.send("error", RunError("died", spinner.nodes[0].spec.name, None, None, text))
    spinner.stop()
    link.closing.set()


def _close(link: Link, nodes: list[LockstepNode]) -> None:
    results = {}
    for node in nodes:
        try:
            node.close()
        except Exception as error:
            name, text = node.spec.name, f"{type(error).__name__}: {error}"
            link.send("error", RunError("record", name, None, node.barrier.tick, text))
        results[node.spec.name] = node.result()
    link.send("result", results)


def _run_error(error: LockstepError) -> RunError:
    return RunError(error.kind, error.node, error.topic, error.tick, str(error))
