"""The supervisor: runs a checked graph as real ROS 2 processes and reports what happened."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any, Literal

from steering_lockstep.graph import Graph

Layout = Literal["one", "each"] | Mapping[str, str]
Phase = Literal["starting", "matching", "running", "closing"]


@dataclass(frozen=True)
class Progress:
    """State of a run. ``tick`` of ``ticks`` done; wall clock in s since the run was started."""

    phase: Phase
    tick: int
    ticks: int
    wall_time: float
    real_time_factor: float


@dataclass(frozen=True)
class RunError:
    """Why a run failed.

    ``kind``: "timeout" (a missing output), "start" (a node did not start or match), "died" (a
    process ended on its own), "not_finite", "size", "order", "core" (a core raised), "record".
    """

    kind: str
    node: str
    topic: str | None
    tick: int | None
    message: str


@dataclass
class RunResult:
    """What a run did. ``ok`` is true only when every tick was done and every node closed well.

    ``counts``: published messages {node: {topic: n}}; ``lost``: gaps in sequence, {topic: n},
    seen by any reader; ``first_tick_time`` is from the call to tick 0 in s, ``wall_time`` from
    tick 0 to the last in s; ``latency``: only in real time, {"p50", "p99", "max" (s),
    "overruns", "ticks"}; ``node_results``: what each node's ``result()`` returned;
    ``stopped_by``: name of the signal that ended the run, or None; ``domain``: ROS_DOMAIN_ID.
    """

    ok: bool
    ticks: int
    wall_time: float
    first_tick_time: float
    counts: dict[str, dict[str, int]] = field(default_factory=dict)
    lost: dict[str, int] = field(default_factory=dict)
    error: RunError | None = None
    stopped_by: str | None = None
    latency: dict[str, float] | None = None
    node_results: dict[str, dict[str, Any]] = field(default_factory=dict)
    domain: int = -1

    @property
    def real_time_factor(self) -> float:
        """Simulated time over wall-clock time, first tick to last."""
        return self.ticks * 1e-3 / self.wall_time if self.wall_time > 0.0 else 0.0


def run_graph(
    graph: Graph,
    ticks: int,
    *,
    parameters: Mapping[str, Mapping[str, Any]] | None = None,
    rest: Mapping[str, Sequence[float]] | None = None,
    layout: Layout = "one",
    real_time: bool = False,
    timeout: float = 2.0,
    start_timeout: float = 60.0,
    grace: float = 2.0,
    on_progress: Callable[[Progress], None] | None = None,
) -> RunResult:
    """Run ``graph`` for ``ticks`` ticks over DDS and return what happened.

    ``parameters``: {node name: {ROS parameter: value}}; ``rest``: {topic: values of the message's
    fields} for delayed inputs before their first message (default zeros); ``layout``: "one" (all
    nodes in a process), "each" (a process each) or {node: process name}. ``timeout``: wall-clock
    seconds without a tick before the run is given up and the culprit named. ``on_progress`` is
    called from the caller's thread about every 100 ticks, and at each change of phase.

    Never raises for a failing run: the reason is ``RunResult.error``. SIGINT and SIGTERM end the
    run in order (``stopped_by``); whatever happens, no process is left when it returns.
    """
    raise NotImplementedError
