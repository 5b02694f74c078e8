"""Speed of the graph over DDS: layouts, recording, rclpy's executor, bare messages.

    steer bench graph_speed
    steer python benchmarks/graph_speed.py --ticks 20000 --rounds 5

The closed-centre bench on the on-centre manoeuvre. All cases run in turns, round after round; a
ratio is the median over the rounds of two times of a tick (1 ms simulated), first to last. "Bare":
the same messages without physics. The default executor is slow, so its runs are shorter.
"""

from __future__ import annotations

import argparse
import statistics
import sys
import tempfile
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import Any, Literal

from steering_bringup.benchmarking.program import Measured, main
from steering_bringup.benchmarking.timing import in_turns, ratio
from steering_bringup.errors import BenchError
from steering_bringup.graphs import build_graph
from steering_bringup.node_parameters import node_parameters
from steering_bringup.scenario_files import load_node_set, load_scenario
from steering_lockstep.graph import Graph, NodeSpec, check_graph
from steering_lockstep.processes import Zygote, run_graph

NODE_SET = "closed_centre"
DEFAULT_EXECUTOR = "rclpy.executors:SingleThreadedExecutor"
TICK = 1e-3  # s
SHARE = {"each": 0.5, "default": 0.1}
LEAST = 50  # ticks


@dataclass(frozen=True)
class Case:
    """One way to run the graph."""

    name: str
    layout: Literal["one", "each"]
    record: bool = False
    bare: bool = False
    executor: str | None = None


LAYOUTS: tuple[Literal["one", "each"], ...] = ("one", "each")
CASES = tuple(
    case
    for layout in LAYOUTS
    for case in (
        Case(layout, layout),
        Case(f"{layout}_recording", layout, record=True),
        Case(f"{layout}_bare", layout, bare=True),
        Case(f"{layout}_default", layout, executor=DEFAULT_EXECUTOR),
    )
)
RATIOS = {
    "to_default": ("_default", ""),
    "to_bare": ("", "_bare"),
    "recording": ("_recording", ""),
}
"""Row to the cases of a layout whose times are divided."""


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


class Bench:
    """Runs the cases and remembers what was lost."""

    def __init__(self, ticks: int, folder: Path, zygote: Zygote) -> None:
        self.ticks = ticks
        self.lost = 0
        self.processor: dict[str, list[float]] = {case.name: [] for case in CASES}
        self._folder = folder
        self._zygote = zygote

    def length(self, case: Case) -> int:
        """Return how many ticks the case runs."""
        share = (SHARE["default"] if case.executor else 1.0) * SHARE.get(case.layout, 1.0)
        return max(LEAST, int(self.ticks * share))

    def tick(self, case: Case) -> float:
        """Run a case; return the wall time of a tick [s]. BenchError for a run that broke off."""
        parameters: dict[str, Any] = {}
        if not case.bare:
            parameters |= node_parameters(load_scenario("on_centre"), load_node_set(NODE_SET))
        if case.record:
            parameters["recorder"] = {"path": str(self._folder / case.name), "overwrite": True}
        result = run_graph(
            graph_of(case),
            self.length(case),
            parameters=parameters,
            layout=case.layout,
            executor=case.executor,
            zygote=self._zygote,
        )
        if not result.ok:
            raise BenchError(f"{case.name}: {result.error.message if result.error else 'stopped'}")
        self.lost += sum(result.lost.values())
        self.processor[case.name].append(result.cpu_time / result.ticks)
        return result.wall_time / result.ticks


def measure(options: argparse.Namespace) -> Measured:
    """Run all cases in turns."""
    modules = ["steering_bringup.recorder_node", "_bare_nodes", "vehicle_model.vehicle_node"]
    with Zygote(modules) as zygote, tempfile.TemporaryDirectory() as folder:
        # Compiles what is not in the cache yet, apart from the measurements.
        Bench(LEAST, Path(folder), zygote).tick(CASES[0])
        bench = Bench(options.ticks, Path(folder), zygote)
        cases = [case for case in CASES if case.layout in options.layouts]
        calls = {case.name: partial(bench.tick, case) for case in cases}
        times = in_turns(calls, options.rounds)
    values: dict[str, float | None] = {"lost": bench.lost}
    for layout in options.layouts:
        for row, (above, below) in RATIOS.items():
            values[f"{layout}_{row}"] = ratio(times[layout + above], times[layout + below])
        for recording in ("", "_recording"):
            tick = statistics.median(times[layout + recording])
            values[f"{layout}{recording}_real_time"] = TICK / tick
    return Measured(values, {"wall_s_per_tick": times, "processor_s_per_tick": bench.processor})


def arguments(parser: argparse.ArgumentParser) -> None:
    """Declare the size."""
    parser.add_argument("--ticks", type=int, default=4000, help="longest run (default: 4000)")
    parser.add_argument("--rounds", type=int, default=3)
    parser.add_argument("--layouts", nargs="+", choices=LAYOUTS, default=list(LAYOUTS))


if __name__ == "__main__":
    sys.exit(main("graph_speed", measure, arguments, __doc__))
