"""The supervisor: runs a checked graph as real ROS 2 processes and reports what happened."""

from __future__ import annotations

import os
from collections.abc import Callable, Mapping, Sequence
from time import monotonic_ns
from typing import Any, Literal

from steering_lockstep.domain import DomainClaim, DomainError, claim_domain
from steering_lockstep.graph import Graph
from steering_lockstep.kinds import programs
from steering_lockstep.middleware import ros_environment
from steering_lockstep.names import NAMES, Names
from steering_lockstep.outcome import Progress, RunError, RunResult
from steering_lockstep.settings import RunSettings
from steering_lockstep.supervision import Child, Supervision
from steering_lockstep.worker_job import Job
from steering_lockstep.zygote import Zygote

__all__ = [
    "START_TIMEOUT",
    "Layout",
    "Progress",
    "RunError",
    "RunResult",
    "Zygote",
    "preload",
    "run_graph",
]

START_TIMEOUT = 180.0
"""s until the first tick: on a slow machine kernels are compiled first."""
Layout = Literal["one", "each"] | Mapping[str, str]


def run_graph(
    graph: Graph,
    ticks: int,
    *,
    parameters: Mapping[str, Mapping[str, Any]] | None = None,
    rest: Mapping[str, Sequence[float]] | None = None,
    layout: Layout = "one",
    real_time: bool = False,
    timeout: float = 2.0,
    start_timeout: float = START_TIMEOUT,
    grace: float = 2.0,
    on_progress: Callable[[Progress], None] | None = None,
    domain: int | DomainClaim | None = None,
    names: Names = NAMES,
    wait_for: Sequence[str] = (),
    zygote: Zygote | None = None,
    executor: str | None = None,
    urgent: bool = False,
    external: Sequence[str] = (),
) -> RunResult:
    """Run ``graph`` for ``ticks`` ticks over DDS and return what happened.

    ``parameters``: {node name: {ROS parameter: value}}; ``rest``: {topic: values of the message's
    fields} for delayed inputs before their first message (default zeros); ``layout``: "one" (all
    nodes in a process), "each" (a process each) or {node: process name}. ``timeout``: wall-clock
    seconds without a tick before the run is given up and the culprit named; ``start_timeout``:
    until the first tick; ``grace``: to close in order before being killed. ``on_progress`` is
    called from the caller's thread about ten times a second and at each change of phase.
    ``domain``: ROS_DOMAIN_ID, or the caller's claim on it; by default a free one. ``names``:
    namespace and new names of topics. ``wait_for``: topics that somebody outside must listen to
    before tick 0. ``zygote``: see ``preload``. ``executor``:
    "module:function" of another rclpy executor, for comparison. ``urgent``: wall time counts
    (hardware is the clock): the nodes' processes are real-time ones where this is permitted.
    ``external``: nodes that are started elsewhere (``standalone.run_alone``), in the same domain.

    Never raises for a failing run: the reason is ``RunResult.error``. SIGINT and SIGTERM end the
    run in order (``stopped_by``; a second one at once); no process is left when it returns.
    """
    called = monotonic_ns()
    settings = RunSettings(
        graph,
        ticks,
        dict(rest or {}),
        real_time,
        urgent,
        names=names,
        wait_for=frozenset(wait_for),
    )
    try:
        if isinstance(domain, DomainClaim):
            claim, lent = domain, True
        else:
            claim, lent = claim_domain(domain, namespace=names.namespace), False
    except DomainError as error:
        failure = RunError("start", "", None, None, str(error))
        return RunResult(error=failure)
    own = zygote is None
    crew = zygote if zygote is not None else preload(graph)
    ros = ros_environment(os.environ)
    supervision = Supervision(settings, timeout, start_timeout, grace, on_progress)
    try:
        with supervision.signals():
            for group in placement(graph, layout, external).values():
                mine = {name: dict((parameters or {}).get(name, {})) for name in group}
                job = Job(group, settings, claim.number, mine, ros, executor, tuple(external))
                supervision.add(Child(group, *crew.fork("steering_lockstep.worker:work", job)))
            result = supervision.run(crew)
    finally:
        if own:
            crew.close()
        if not lent:
            claim.release()
    result.domain = claim.number
    if supervision.started_at:
        result.first_tick_time = (supervision.started_at - called) * 1e-9
    return result


def preload(graph: Graph) -> Zygote:
    """Start a zygote that imports the programs of ``graph``'s nodes in the background.

    Hand it to several runs, or make it early, to save about a second each.
    """
    return Zygote(programs(node.kind for node in graph.nodes))


def placement(
    graph: Graph, layout: Layout, external: Sequence[str] = ()
) -> dict[str, tuple[str, ...]]:
    """Return which nodes run in which process: {process: node names}, without ``external``."""
    processes: dict[str, tuple[str, ...]] = {}
    for node in (n for n in graph.nodes if n.name not in external):
        if layout == "one":
            process = "bench"
        elif layout == "each":
            process = node.name
        else:
            process = layout.get(node.name, "bench")
        processes[process] = (*processes.get(process, ()), node.name)
    return processes
