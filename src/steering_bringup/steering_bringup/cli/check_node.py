"""``steer check-node``: an overlay node under every fault that the bench knows."""

from __future__ import annotations

import argparse
import shlex
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING

from steering_bringup.cli.ros_options import add_domain, settle_domain
from steering_bringup.errors import BenchError
from steering_bringup.outputs import write_json

if TYPE_CHECKING:
    from steering_bringup.check_node.judge import Verdict
    from steering_bringup.check_node.record import Subject

EXAMPLES = """examples:
  steer check-node python3 pull_left.py            a node that publishes on /torque_overlay
  steer check-node 'ros2 run my_package my_node --ros-args -p gain:=2.0'
  steer check-node lane_keeper                     a member of the lock step, by its kind
  steer check-node my_keeper:make --inputs /vehicle/odometry /steering/torque --period 10
  steer check-node python3 pull_left.py --faults none inputs-stop killed"""


def arguments(parser: argparse.ArgumentParser) -> None:
    """Declare the options."""
    add = parser.add_argument
    add("node", metavar="CMD", nargs="+", help="command line, or a kind of node (MODULE:FUNCTION)")
    add("--faults", metavar="NAME", nargs="+", help="these only (default: all)")
    add("--inputs", metavar="TOPIC", nargs="+", default=["/vehicle/odometry"], help="of a kind")
    add("--period", metavar="TICKS", type=int, default=10, help="of a kind, in ms (default: 10)")
    add("--scenario", metavar="NAME", default="overlay_check", help="the drive, by name or file")
    add_domain(parser)
    add("--timeout", metavar="S", type=float, default=20.0, help="for the node to come up")
    add("--json", metavar="FILE", type=Path, help="write the verdicts for machines")


def execute(options: argparse.Namespace) -> int:
    """Check, print the table, and tell by the status whether all passed."""
    from steering_bringup.check_node.checking import check

    settle_domain(options)
    subject = _subject(options)
    verdicts = check(subject, options.scenario, options.faults, options.timeout)
    print("\n".join(table(verdicts)))
    failed = [v for v in verdicts if not v.passed]
    if options.json:
        report = {"passed": not failed, "verdicts": [v.as_json() for v in verdicts]}
        write_json(options.json, report)
    return 1 if failed else 0


def _subject(options: argparse.Namespace) -> Subject:
    from steering_bringup.check_node.record import Subject
    from steering_lockstep.kinds import FACTORIES
    from steering_lockstep.topics import TABLE

    words: Sequence[str] = options.node
    if len(words) == 1:
        words = shlex.split(words[0])
    if not words:
        raise BenchError("name the node: a command line, or a kind such as lane_keeper")
    if len(words) > 1 or not (words[0] in FACTORIES or is_kind(words[0])):
        return Subject("guest", tuple(words))
    for name in options.inputs:
        if name not in TABLE:
            raise BenchError(f"--inputs: there is no topic {name} (see docs/signs_and_units.md)")
    if not 1 <= options.period <= 1000:
        raise BenchError(f"--period must be from 1 to 1000 ticks, got {options.period}")
    return Subject("member", tuple(words), tuple(options.inputs), options.period)


def is_kind(word: str) -> bool:
    """Return whether a word reads MODULE:FUNCTION."""
    module, sign, function = word.partition(":")
    return bool(sign) and function.isidentifier() and module.replace(".", "_").isidentifier()


def table(verdicts: Sequence[Verdict]) -> list[str]:
    """Return the verdicts as lines: one block a fault, then the count."""
    lines = []
    for v in verdicts:
        lines.append(f"{'passed' if v.passed else 'FAILED'}  {v.fault:<14}{v.injected}")
        lines += [f"        {'node':<14}{v.node}", f"        {'arbiter':<14}{v.arbiter}"]
        if v.change:
            lines.append(f"        {'change':<14}{v.change}")
    failed = sum(not v.passed for v in verdicts)
    lines.append(f"{len(verdicts) - failed} of {len(verdicts)} passed")
    return lines
