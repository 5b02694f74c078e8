"""``steer compare``: two bags on one page."""

from __future__ import annotations

import argparse
import json
from pathlib import Path

EXAMPLES = """example:
  steer compare results/on_centre-1/open_centre results/on_centre-1/closed_centre"""


def arguments(parser: argparse.ArgumentParser) -> None:
    """Declare the options."""
    add = parser.add_argument
    add("first", metavar="BAG", type=Path, help="the reference")
    add("second", metavar="BAG", type=Path, help="what is compared with it")
    add(
        "--out", metavar="DIR", type=Path, help="folder of the page (default: results/comparison-n)"
    )
    add("--json", metavar="FILE", type=Path, help="write the numbers for machines")


def execute(options: argparse.Namespace) -> int:
    """Compare, write the page, print the key numbers."""
    from steering_bringup.checks import free_folder
    from steering_bringup.session import compare_bags, make_folder

    folder = options.out or free_folder(Path("results"), "comparison")
    make_folder(folder)
    page = folder / "comparison.html"
    text, numbers = compare_bags(options.first, options.second, page)
    print("\n".join(text))
    print(f"page: {page}")
    if options.json:
        options.json.write_text(json.dumps(numbers, indent=2) + "\n", encoding="utf-8")
    return 0
