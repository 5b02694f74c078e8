"""``steer linear``: Bode plots, margins and design studies of valves, controllers and steering."""

from __future__ import annotations

import argparse
from pathlib import Path

from steering_bringup.outputs import write_json

EXAMPLES = """examples:
  steer linear open-centre steering
  steer linear latency --set valve_controller.damping=1.0
  steer linear tolerance --count 500 --seed 2 --json tolerance.json

Studies: open-centre, valve, steering, chattering, lag, latency, tolerance (default: all).
docs/linear.md says what they show."""


def arguments(parser: argparse.ArgumentParser) -> None:
    """Declare the options."""
    add = parser.add_argument
    add("studies", metavar="STUDY", nargs="*", help="studies to make (default: all)")
    add("--set", metavar="NAME=VALUE", action="append", default=[], help="parameters, SI")
    add("--count", type=int, default=100, help="specimens of the tolerance study (default: 100)")
    add("--seed", type=int, default=1, help="seed of the tolerance study (default: 1)")
    add("--out", metavar="DIR", type=Path, help="folder (default: results/linear-1, -2, ...)")
    add("--json", metavar="FILE", type=Path, help="write the figures of merit for machines")


def execute(options: argparse.Namespace) -> int:
    """Make the studies, print their tables, write the page."""

    from steering_bringup.checks import free_folder
    from steering_bringup.errors import BenchError
    from steering_bringup.pages import Page, table
    from steering_core.naming import unknown
    from steering_core.parameters import load_parameters
    from steering_studies.linear.sections import SECTIONS, Wish, plain
    from steering_studies.settings import parameters_of

    for name in options.studies:
        if name not in SECTIONS:
            raise BenchError(unknown("study", name, SECTIONS))
    if options.count < 1:
        raise BenchError(f"--count must be at least 1, got {options.count}")
    parameters = load_parameters().with_values(parameters_of(options.set))
    chosen = [name for name in SECTIONS if not options.studies or name in options.studies]
    page = Page("Linear analysis and controller design", ", ".join(chosen))
    numbers = {}
    with _bar(chosen, options.count) as step:
        wish = Wish(options.count, options.seed, step)
        for name in chosen:
            section = SECTIONS[name](parameters, wish)
            step(0, name)
            page.heading(section.title)
            for figure in section.figures:
                page.add(figure)
            for title, head, rows in section.tables:
                page.heading(title)
                page.add(table(head, rows))
                print(_text_table(title, head, rows))
            numbers[name] = plain(section.numbers)
    folder = options.out or free_folder(Path("results"), "linear")
    print(f"page: {page.write(folder / 'linear.html')}")
    if options.json:
        write_json(options.json, numbers)
        print(f"numbers: {options.json}")
    return 0


class _bar:  # noqa: N801
    """A bar over studies and specimens, on a terminal only; called as step(done, study)."""

    def __init__(self, studies: list[str], count: int) -> None:
        import sys

        from tqdm import tqdm

        shown = sys.stdout.isatty() and sys.stderr.isatty()
        self.bar = tqdm(total=len(studies), disable=not shown, leave=False, desc=studies[0])
        self.count = count

    def __enter__(self) -> _bar:
        return self

    def __exit__(self, *error: object) -> None:
        self.bar.close()

    def __call__(self, done: int, study: str = "") -> None:
        """Show a finished study, or how many specimens are done."""
        if study:
            self.bar.update(1)
            self.bar.set_description(f"after {study}")
        else:
            self.bar.set_postfix_str(f"{done} of {self.count} specimens")


def _text_table(title: str, head: list[str], rows: list[list[str]]) -> str:
    widths = [max(len(row[k]) for row in [head, *rows]) for k in range(len(head))]
    lines = [
        "  "
        + "  ".join(cell.ljust(width) for cell, width in zip(row, widths, strict=True)).rstrip()
        for row in [head, *rows]
    ]
    return "\n".join([title, *lines, ""])
