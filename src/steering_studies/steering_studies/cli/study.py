"""``steer study``: questions beyond the source, each answered on one page."""

from __future__ import annotations

import argparse
from pathlib import Path

from steering_bringup.outputs import write_json

EXAMPLES = """examples:
  steer study                     lists the questions
  steer study energy
  steer study heavy_vehicle --set mechanics.rack_friction=400"""


def arguments(parser: argparse.ArgumentParser) -> None:
    """Declare the options."""
    add = parser.add_argument
    add("studies", metavar="STUDY", nargs="*", help="(default: list them)")
    add("--set", metavar="NAME=VALUE", action="append", default=[], help="a parameter; repeatable")
    add("--out", metavar="DIR", type=Path, help="folder (default: results/study-1, -2, ...)")
    add("--json", metavar="FILE", type=Path, help="write the numbers for machines")


def execute(options: argparse.Namespace) -> int:
    """Answer the questions, each on a page of its own."""

    from steering_bringup.checks import free_folder
    from steering_bringup.errors import BenchError
    from steering_core.naming import unknown
    from steering_studies.beyond.all_studies import STUDIES
    from steering_studies.pages.study import study_page
    from steering_studies.settings import parameters_of

    for name in options.studies:
        if name not in STUDIES:
            raise BenchError(unknown("study", name, STUDIES))
    if not options.studies:
        for study in STUDIES.values():
            print(f"{study.name:18} {study.question}")
        return 0
    folder = options.out or free_folder(Path("results"), "study")
    numbers = {}
    for name in options.studies:
        answer = STUDIES[name].answer(parameters_of(options.set))
        page = study_page(STUDIES[name], answer).write(folder / f"{name}.html")
        print(f"{name}: {answer.sentence}\npage: {page}")
        numbers[name] = answer.numbers
    if options.json:
        write_json(options.json, numbers)
    return 0
