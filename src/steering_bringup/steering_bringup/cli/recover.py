"""``steer recover``: repair bags that a crash cut off."""

from __future__ import annotations

import argparse
from pathlib import Path

EXAMPLES = """example:
  steer recover results/on_centre-1/closed_centre"""


def arguments(parser: argparse.ArgumentParser) -> None:
    """Declare the options."""
    parser.add_argument("bag", metavar="BAG", type=Path, nargs="+", help="folder of a bag")


def execute(options: argparse.Namespace) -> int:
    """Repair each bag and tell what could be kept."""
    from steering_bringup.bags import repair

    for bag in options.bag:
        print(f"{bag}: {repair(bag)}")
    return 0
