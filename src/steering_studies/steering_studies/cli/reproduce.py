"""``steer reproduce``: every figure of the source, with its numbers beside ours."""

from __future__ import annotations

import argparse
import os
from pathlib import Path

from steering_bringup.outputs import write_json

EXAMPLES = """examples:
  steer reproduce
  steer reproduce rig.boost_curve valve.step_responses
  steer reproduce --list"""


def arguments(parser: argparse.ArgumentParser) -> None:
    """Declare the options."""
    add = parser.add_argument
    add("rows", metavar="ROW", nargs="*", help="(default: all)")
    add("--list", action="store_true", help="list the rows")
    add("--jobs", metavar="N", type=int, default=os.cpu_count() or 1, help="processes")
    add("--out", metavar="DIR", type=Path, help="folder (default: results/reproduction-1, ...)")
    add("--json", metavar="FILE", type=Path, help="write the numbers for machines")


def execute(options: argparse.Namespace) -> int:
    """Make the rows, write the page, print a line a figure."""

    from steering_bringup.checks import free_folder
    from steering_bringup.progress import Steps
    from steering_studies.pages.reproduce import reproduction_page
    from steering_studies.parallel import pool
    from steering_studies.reproduce.all_rows import ROWS, make

    if options.list:
        for name, maker in ROWS.items():
            print(f"{name:32} {(maker.__doc__ or '').removeprefix('Return ').splitlines()[0]}")
        return 0
    with pool(options.jobs) as executor, Steps("reproduce") as progress:
        rows = make(options.rows, executor, progress)
    folder = options.out or free_folder(Path("results"), "reproduction")
    page = reproduction_page(rows).write(folder / "reproduction.html")
    for row in rows:
        print(f"{row.name:16} {row.verdict:11} {row.title}")
        for number in row.numbers:
            if number.good is False:
                print(f"    {number.what}: {number.ours:.3g} {number.unit}, "
                      f"source {number.sense} {number.source:g}")  # fmt: skip
    print(f"page: {page}")
    if options.json:
        numbers = [
            {
                "figure": row.figure,
                "title": row.title,
                "verdict": row.verdict,
                "sentence": row.sentence(),
                "numbers": [
                    {"what": n.what, "unit": n.unit, "source": n.source, "ours": n.ours,
                     "tolerance": n.tolerance, "sense": n.sense, "good": n.good}
                    for n in row.numbers
                ],
            }
            for row in rows
        ]  # fmt: skip
        write_json(options.json, numbers)
    return 0
