"""``steer compare``: two bags or measured files on one page."""

from __future__ import annotations

import argparse
from pathlib import Path

from steering_bringup.outputs import write_json

EXAMPLES = """examples:
  steer compare results/on_centre-1/open_centre results/on_centre-1/closed_centre
  steer compare rig/monday drive.mf4 --mapping drive.yaml
  steer compare before.csv after.mf4 --mapping before.yaml --mapping-b after.yaml

Each is a bag, of the bench or of another tool, or a CSV, MATLAB or MDF4 file with a mapping file.
What both hold is compared, tick by tick; the rest is named."""


def arguments(parser: argparse.ArgumentParser) -> None:
    """Declare the options."""
    add = parser.add_argument
    add("first", metavar="DATA", type=Path, help="the reference: bag, or file with --mapping")
    add("second", metavar="DATA", type=Path, help="what is compared with it")
    add("--mapping", metavar="FILE", type=Path, help="what the channels of foreign files are")
    add("--mapping-b", metavar="FILE", type=Path, help="that of the second, where it differs")
    add(
        "--out", metavar="DIR", type=Path, help="folder of the page (default: results/comparison-n)"
    )
    add("--json", metavar="FILE", type=Path, help="write the numbers for machines")


def execute(options: argparse.Namespace) -> int:
    """Compare, write the page, print the key numbers."""
    from steering_bringup.checks import free_folder
    from steering_bringup.outputs import check_folder
    from steering_bringup.session import compare_traces, make_folder
    from steering_diagnosis.data.compared import trace_of

    folder = options.out or free_folder(Path("results"), "comparison")
    check_folder(folder)
    first = trace_of(options.first, options.mapping)
    second = trace_of(options.second, options.mapping_b or options.mapping)
    make_folder(folder)
    page = folder / "comparison.html"
    text, numbers = compare_traces(first, second, page)
    print("\n".join(text))
    print(f"page: {page}")
    if options.json:
        write_json(options.json, numbers)
    return 0
