"""``steer repeat``: run again what a bag records and compare the bytes."""

from __future__ import annotations

import argparse
import sys
from pathlib import Path

from steering_bringup.cli.ros_options import add_domain, settle_domain

EXAMPLES = """examples:
  steer repeat results/on_centre-1/closed_centre
  steer repeat results/on_centre-1/closed_centre --direct
  steer repeat results/on_centre-1/closed_centre --processes each"""


def arguments(parser: argparse.ArgumentParser) -> None:
    """Declare the options."""
    add = parser.add_argument
    add("bag", metavar="BAG", type=Path, help="folder of a recorded run")
    add("--direct", action="store_true", help="without ROS")
    add("--processes", choices=("one", "each"), help="all nodes in one process, or one each")
    add_domain(parser)
    add("--out", metavar="DIR", type=Path, help="folder of the new bag (default: results/repeat-n)")


def execute(options: argparse.Namespace) -> int:
    """Run again; exit status 0 only where every recorded byte is the same."""
    from steering_bringup.bags import first_difference, read_bag
    from steering_bringup.checks import free_folder
    from steering_bringup.cli import FAILED
    from steering_bringup.repeating import differing_surroundings, plan_from_bag
    from steering_bringup.session import run_all
    from steering_bringup.summary import lines

    settle_domain(options)
    recorded = read_bag(options.bag, repair_damage=False)
    folder = options.out or free_folder(Path("results"), "repeat")
    runner = "direct" if options.direct else None
    plan = plan_from_bag(recorded, folder / "bag", runner=runner, processes=options.processes)
    for line in differing_surroundings(recorded):
        print(f"note: {line}")
    (outcome,) = run_all([plan], lambda done: print("\n".join(lines(done))), None, print)
    if not outcome.ok or outcome.bag is None:
        print(f"steer repeat: {outcome.error or outcome.stopped_by}", file=sys.stderr)
        return FAILED
    difference = first_difference(recorded, read_bag(outcome.bag))
    if difference is None:
        print(f"the same, bit for bit: {outcome.messages} messages")
        return 0
    print(f"steer repeat: not the same: {difference}", file=sys.stderr)
    return FAILED
