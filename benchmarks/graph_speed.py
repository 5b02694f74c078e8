"""Speed of the graph over DDS, all in one run: layouts, recording, executors, bare messages.

    python benchmarks/graph_speed.py --json graph_speed.json

Each row is wall-clock time and processor time of a tick (1 ms simulated), first to last, of the
closed-centre bench on the on-centre manoeuvre; "bare": the same messages without physics.
"""

from __future__ import annotations

import argparse
import json
import os
import tempfile
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Literal

from steering_bringup.cores import node_parameters
from steering_bringup.graphs import build_graph
from steering_bringup.scenario_files import load_node_set, load_scenario
from steering_lockstep.graph import Graph, NodeSpec, check_graph
from steering_lockstep.processes import Zygote, run_graph

NODE_SET = "closed_centre"
DEFAULT_EXECUTOR = "rclpy.executors:SingleThreadedExecutor"
SHARE = {"each": 0.5, "default": 0.05}


@dataclass(frozen=True)
class Case:
    """One measurement. ``target``: least ratio to real time, where there is one."""

    name: str
    layout: Literal["one", "each"]
    record: bool = False
    bare: bool = False
    executor: str | None = None
    target: float | None = None


CASES = (
    Case("one process", "one", target=4.0),
    Case("one process, recording", "one", record=True, target=2.5),
    Case("a process each", "each", target=1.5),
    Case("a process each, recording", "each", record=True, target=1.2),
    Case("one process, bare messages", "one", bare=True),
    Case("a process each, bare messages", "each", bare=True),
    Case("one process, default executor", "one", executor=DEFAULT_EXECUTOR),
    Case("a process each, default executor", "each", executor=DEFAULT_EXECUTOR),
)


def graph_of(case: Case) -> Graph:
    """Return the graph of a case; the bare one has the same connections and other programs."""
    graph = build_graph(load_node_set(NODE_SET), {}, truth=False, record=case.record)
    if not case.bare:
        return graph
    return check_graph(
        NodeSpec(n.name, _bare_kind(n), n.inputs, n.outputs, n.period) for n in graph.nodes
    )


def _bare_kind(node: NodeSpec) -> str:
    return f"_bare_nodes:{'clock' if '/clock' in node.outputs else 'node'}"


def measure(case: Case, ticks: int, folder: Path, zygote: Zygote) -> dict[str, Any]:
    """Run a case and return its numbers."""
    ticks = int(ticks * (SHARE["default"] if case.executor else 1.0))
    ticks = int(ticks * (SHARE["each"] if case.layout == "each" else 1.0))
    scenario = load_scenario("on_centre")
    parameters = node_parameters(scenario, load_node_set(NODE_SET))
    if case.bare:
        parameters = {}
    if case.record:
        bag = folder / case.name.replace(" ", "_")
        parameters["recorder"] = {"path": str(bag), "overwrite": True}
    result = run_graph(
        graph_of(case),
        ticks,
        parameters=parameters,
        layout=case.layout,
        executor=case.executor,
        zygote=zygote,
    )
    return {
        "ok": result.ok,
        "error": result.error.message if result.error else None,
        "ticks": result.ticks,
        "ratio": result.real_time_factor,
        "target": case.target,
        "tick_us": result.wall_time / max(1, result.ticks) * 1e6,
        "cpu_us": result.cpu_time / max(1, result.ticks) * 1e6,
        "messages": sum(sum(counts.values()) for counts in result.counts.values()),
        "lost": sum(result.lost.values()),
        "first_tick_s": result.first_tick_time,
        "load_average": os.getloadavg()[0],
    }


def show(name: str, row: dict[str, Any]) -> None:
    """Print one row of the table."""
    target = "" if row["target"] is None else f"target {row['target']:.1f}"
    outcome = row["error"] or f"{row['lost']} lost"
    print(
        f"{name:34s} {row['ratio']:6.2f} x  {row['tick_us']:8.1f} us a tick  "
        f"{row['cpu_us']:8.1f} us of processor  {outcome:8s}  {target}",
        flush=True,
    )


def main() -> int:
    """Measure all cases; status 0 if every run was complete."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--json", type=Path, metavar="FILE", help="write the numbers there")
    parser.add_argument("--ticks", type=int, default=20_000, help="longest run (default: 20000)")
    options = parser.parse_args()
    rows: dict[str, dict[str, Any]] = {}
    modules = ["steering_bringup.recorder_node", "_bare_nodes", "vehicle_model.vehicle_node"]
    with Zygote(modules) as zygote, tempfile.TemporaryDirectory() as folder:
        # Compiles what is not in the cache yet, apart from the measurements.
        measure(CASES[0], 100, Path(folder), zygote)
        for case in CASES:
            rows[case.name] = measure(case, options.ticks, Path(folder), zygote)
            show(case.name, rows[case.name])
    if options.json:
        options.json.write_text(json.dumps(rows, indent=2) + "\n", encoding="utf-8")
    return 0 if all(row["ok"] and not row["lost"] for row in rows.values()) else 1


if __name__ == "__main__":
    raise SystemExit(main())
