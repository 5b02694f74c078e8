"""``steer graph``: all that the nodes of a run must know, as one file for their executables."""

from __future__ import annotations

import argparse
from pathlib import Path

from steering_bringup.cli.ros_options import add_names
from steering_bringup.cli.run import a_rig, plans_of, scenario_of, what_runs
from steering_bringup.errors import BenchError
from steering_bringup.plans import Plan

EXAMPLES = """examples:
  steer graph step --out step.json
  ros2 run steering_plant plant_node --graph step.json --real-time
  steer graph on_centre --node-set closed_centre --record results/mine --out mine.json
  steer graph lane_keeping --set vehicle.speed=25 --out keeping.json

Each node is started by its executable, on this or another computer, in any order; they wait for
each other. ros2 launch steering_bringup bench.launch.py does all of this (docs/ros.md)."""


def arguments(parser: argparse.ArgumentParser) -> None:
    """Declare the options."""
    what_runs(parser)
    how = parser.add_argument_group("how it runs")
    how.add_argument("--real-time", action="store_true", help="pace the ticks to the wall clock")
    add_names(how)
    how.add_argument(
        "--wait-for",
        metavar="TOPIC",
        action="append",
        default=[],
        help="tick 0 comes when somebody outside listens to this topic; repeatable",
    )
    a_rig(parser)
    add = parser.add_argument_group("what is kept").add_argument
    add("--out", metavar="FILE", type=Path, required=True, help="the file to write")
    add("--record", metavar="BAG", type=Path, help="record to this folder (default: nothing)")
    add("--compress", choices=("zstd",), help="compress the bag (default: not)")
    add("--truth", action=argparse.BooleanOptionalAction, help="true states of the plant too")
    # Nobody supervises such nodes: what a run knows beyond this stays at its default.
    parser.set_defaults(
        direct=False, processes="each", domain=None, external=[], timeout=2.0, wait=60.0
    )


def execute(options: argparse.Namespace) -> int:
    """Write the file and say what starts its nodes."""
    from steering_bringup.graph_run import write_graph_file
    from steering_lockstep.executables import executable

    plan = plan_of(options)
    write_graph_file(plan, options.out)
    for node in plan.graph.nodes:
        package, program = executable(node.kind)
        print(f"ros2 run {package} {program} --graph {options.out} --name {node.name}")
    return 0


def plan_of(options: argparse.Namespace) -> Plan:
    """Return the checked plan of the one node set that is asked for."""
    options.no_record = options.record is None
    scenario = scenario_of(options)
    if len(scenario.node_set) > 1 and options.node_set is None:
        raise BenchError(
            f"scenario '{scenario.name}' has {len(scenario.node_set)} node sets: choose one with "
            f"--node-set, such as {scenario.node_set[-1]}"
        )
    if options.record is not None:
        from steering_bringup.checks import check_place

        options.record = options.record.absolute()
        check_place(options.record)
    (plan,) = plans_of(options, scenario, Path())
    return plan
