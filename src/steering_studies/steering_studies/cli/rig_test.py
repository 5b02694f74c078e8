"""``steer rig-test``: the source's rig tests on the simulated plant."""

from __future__ import annotations

import argparse
from pathlib import Path

from steering_bringup.cli.ros_options import add_domain, settle_domain
from steering_bringup.outputs import write_json

EXAMPLES = """examples:
  steer rig-test                              every test, without ROS
  steer rig-test rack_friction stiffness --set mechanics.rack_friction=80
  steer rig-test boost_curve --graph          through the ROS graph
  steer rig-test --list

Each run is recorded to a bag. 'steer identify FOLDER' tells what the bags say of the gear; it takes
bags of a rig as well, recorded under the same names."""


def arguments(parser: argparse.ArgumentParser) -> None:
    """Declare the options."""
    add = parser.add_argument
    add("tests", metavar="TEST", nargs="*", help="(default: all)")
    add("--list", action="store_true", help="list the tests and their runs")
    add("--set", metavar="NAME=VALUE", action="append", default=[], help="a parameter; repeatable")
    add("--exact", action="store_true", help="ideal sensors instead of usual ones")
    add("--graph", action="store_true", help="through the ROS graph")
    add_domain(parser)
    add("--out", metavar="DIR", type=Path, help="folder (default: results/rig_test-1, -2, ...)")
    add("--json", metavar="FILE", type=Path, help="write the outcomes for machines")


def execute(options: argparse.Namespace) -> int:
    """Run and record the tests, then tell where they are."""

    from steering_bringup.checks import free_folder
    from steering_bringup.summary import lines
    from steering_studies.rig_tests.record import record
    from steering_studies.rig_tests.simulate import TYPICAL_NOISE
    from steering_studies.rig_tests.tests import RIG_TESTS
    from steering_studies.settings import parameters_of

    if options.list:
        for test in RIG_TESTS.values():
            print(f"{test.name:16} {test.purpose} ({test.figure})")
        return 0
    settle_domain(options)
    folder = options.out or free_folder(Path("results"), "rig_test")
    noise = {} if options.exact else TYPICAL_NOISE
    outcomes = record(
        options.tests or RIG_TESTS,
        folder,
        "graph" if options.graph else "direct",
        {**noise, **parameters_of(options.set)},
        {},
        lambda outcome: print(lines(outcome)[0], flush=True),
    )
    if options.json:
        report = {"runs": [outcome.as_json() for outcome in outcomes]}
        write_json(options.json, report)
    failed = [outcome for outcome in outcomes if not outcome.ok]
    print(f"bags: {folder}  (steer identify {folder})")
    return 1 if failed else 0
