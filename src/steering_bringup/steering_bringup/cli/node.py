"""``steer node``: one node of a run, in this process, on this or any other computer."""

from __future__ import annotations

import argparse
from pathlib import Path

from steering_bringup.cli.ros_options import add_domain, settle_domain
from steering_bringup.errors import BenchError
from steering_core.naming import unknown

EXAMPLES = """examples:
  steer run lane_keeping --external lane_keeper --domain 42 --out results/two
  ROS_DOMAIN_ID=42 steer node results/two/nodes.json lane_keeper

The file is all that the other computer needs beside the software: copy it there. For another
computer set ROS_AUTOMATIC_DISCOVERY_RANGE=SUBNET on both sides (docs/several_computers.md)."""


def arguments(parser: argparse.ArgumentParser) -> None:
    """Declare the options."""
    add = parser.add_argument
    add("file", metavar="FILE", type=Path, help="nodes.json of 'steer run --external'")
    add("name", metavar="NODE", help="the node's name in it")
    add_domain(parser, "0")
    add("--wait", metavar="S", type=float, default=60.0, help="s for the run (default: 60)")
    add("--timeout", metavar="S", type=float, default=10.0, help="s without a tick (default: 10)")


def execute(options: argparse.Namespace) -> int:
    """Run the node to its last tick."""
    from steering_lockstep.graph import GraphError
    from steering_lockstep.graph_file import read_run
    from steering_lockstep.kinds import factory
    from steering_lockstep.standalone import run_alone

    if not (options.wait > 0.0 and options.timeout > 0.0):
        raise BenchError("--wait and --timeout must be greater than 0 s")
    settle_domain(options)
    try:
        run, parameters = read_run(options.file)
    except GraphError as error:
        raise BenchError(str(error)) from None
    if options.name not in parameters:
        raise BenchError(f"{options.file}: {unknown('node', options.name, parameters)}")
    spec = run.graph.node(options.name)
    try:
        make = factory(spec.kind)
    except (ImportError, AttributeError, KeyError) as error:
        raise BenchError(f"node '{spec.name}' of kind '{spec.kind}': {error}") from None
    values = parameters[options.name]
    return run_alone(make, spec, run, values, options.wait, options.timeout)
