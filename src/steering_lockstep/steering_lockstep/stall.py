"""Who is to blame when nothing moves: from what every node says it lacks. Pure."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

from steering_lockstep.graph import Graph


@dataclass(frozen=True)
class Report:
    """What a node says: it works on ``tick``, and waits for ``lacking`` (or computes: ``busy``)."""

    tick: int
    lacking: tuple[str, ...] = ()
    busy: bool = False


@dataclass(frozen=True)
class Culprit:
    """The root of a stall: ``node`` owes ``topic`` at ``tick``, because ``reason``."""

    node: str
    topic: str | None
    tick: int | None
    reason: str


def culprit(reports: Mapping[str, Report], graph: Graph) -> Culprit:
    """Return the root cause of a stall, following from the clock what each node lacks.

    A node without a report is silent: dead, stopped or stuck. A waiting node is never blamed for
    its wait; the trail goes on to the publisher of what it lacks. A publisher that has passed the
    missing tick is not late: the message was lost on the way.
    """
    name, topic, tick = graph.clock.name, None, None
    visited: set[str] = set()
    while True:
        report = reports.get(name)
        if report is None:
            return Culprit(name, topic, tick, "it is silent: dead, stopped or stuck in its step")
        if report.busy:
            return Culprit(name, topic, tick, f"it has not finished its step of tick {report.tick}")
        # The clock publishes a tick before it collects it, the others after.
        node = graph.node(name)
        published = report.tick if node == graph.clock else report.tick - node.period
        if tick is not None and published >= tick:
            return Culprit(name, topic, tick, "it was published but has not arrived")
        if not report.lacking:
            return Culprit(name, topic, tick, "it lacks nothing but has not published")
        if name in visited:
            return Culprit(name, topic, tick, "nodes wait for each other")
        visited.add(name)
        topic = _most_blamed(report, reports, graph)
        tick = report.tick - node.inputs.get(topic, 0)
        name = graph.publisher[topic]


def _most_blamed(report: Report, reports: Mapping[str, Report], graph: Graph) -> str:
    """Of what a node lacks, prefer what comes from a node that is not itself waiting."""

    def innocent(topic: str) -> bool:
        source = reports.get(graph.publisher[topic])
        return source is not None and not source.busy and bool(source.lacking)

    return min(report.lacking, key=innocent)
