"""What a run tells: progress on the way, the outcome at the end. Pure."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any, Literal

Phase = Literal["starting", "matching", "running", "closing"]
TICK_PERIOD = 1e-3


@dataclass(frozen=True)
class Progress:
    """State of a run. ``tick`` of ``ticks`` done; ``wall_time`` in s since the first tick."""

    phase: Phase
    tick: int
    ticks: int
    wall_time: float

    @property
    def real_time_factor(self) -> float:
        """Simulated time over wall-clock time since the first tick."""
        return self.tick * TICK_PERIOD / self.wall_time if self.wall_time > 0.0 else 0.0


@dataclass(frozen=True)
class RunError:
    """Why a run failed.

    ``kind``: "timeout" (a missing output), "start" (a node did not start or match), "died" (a
    process ended on its own), "not_finite", "size", "order", "core" (a core raised), "record",
    "rig" (the hardware was made safe).
    """

    kind: str
    node: str
    topic: str | None
    tick: int | None
    message: str


@dataclass
class RunResult:
    """What a run did. ``ok`` is true only when every tick was done and every node closed well.

    ``ticks``: those done; ``counts``: published messages {node: {topic: n}}; ``lost``: gaps in
    sequence {topic: n} seen by the recorder (a gap at any other node ends the run with an error);
    ``first_tick_time`` is from the call to tick 0 in s, ``wall_time`` from tick 0 to the last in
    s, ``cpu_time`` that of all node processes in the meantime in s; ``latency``: only in real
    time, {"p50", "p99", "max" (s), "overruns", "ticks"}; ``node_results``: what each node's
    ``result()`` returned; ``stopped_by``: name of the signal that ended the run, or None;
    ``domain``: ROS_DOMAIN_ID.
    """

    ok: bool = False
    ticks: int = 0
    wall_time: float = 0.0
    first_tick_time: float = 0.0
    cpu_time: float = 0.0
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
        return self.ticks * TICK_PERIOD / self.wall_time if self.wall_time > 0.0 else 0.0
