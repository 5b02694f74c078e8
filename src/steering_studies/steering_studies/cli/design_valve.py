"""``steer design-valve``: step time against solenoid force, two methods, one page."""

from __future__ import annotations

import argparse
import os
from pathlib import Path

from steering_bringup.outputs import write_json

EXAMPLES = """examples:
  steer design-valve
  steer design-valve --seed 7 --method complex
  steer design-valve --set oil.bulk_modulus=1.4e9 --json front.json"""


def arguments(parser: argparse.ArgumentParser) -> None:
    """Declare the options."""
    add = parser.add_argument
    add("--method", choices=("both", "complex", "nsga"), default="both", help="(default: both)")
    add("--seed", type=int, default=1, help="of the searches: the same seed, the same front")
    add("--set", metavar="NAME=VALUE", action="append", default=[], help="a parameter; repeatable")
    add("--jobs", metavar="N", type=int, default=os.cpu_count() or 1, help="processes")
    add("--out", metavar="DIR", type=Path, help="folder (default: results/valve_design-1, ...)")
    add("--json", metavar="FILE", type=Path, help="write the fronts for machines")


def execute(options: argparse.Namespace) -> int:
    """Search, compare the fronts with the data sheet's valve, write the page."""

    from pressure_control.valve_design.front import complex_front, distance_to, nsga_front
    from pressure_control.valve_design.problem import DesignProblem
    from steering_bringup.checks import free_folder
    from steering_bringup.progress import Steps
    from steering_core.parameters import load_parameters
    from steering_studies.pages.valve_design import valve_design_page
    from steering_studies.parallel import pool
    from steering_studies.settings import parameters_of
    from steering_studies.valve_design import behaviour, chosen_design, nominal_design

    parameters = load_parameters().with_values(parameters_of(options.set))
    searches = {"complex": complex_front, "nsga": nsga_front}
    wanted = searches if options.method == "both" else {options.method: searches[options.method]}
    with pool(options.jobs) as executor, Steps("design") as progress:
        fronts = [
            search(parameters, options.seed, executor, progress) for search in wanted.values()
        ]
    problem = DesignProblem(parameters)
    chosen = chosen_design(fronts[-1])
    found, sheet = problem.evaluate(chosen), problem.evaluate(nominal_design(parameters))
    made = behaviour(problem.parameters_of(chosen))
    folder = options.out or free_folder(Path("results"), "valve_design")
    page = valve_design_page(fronts, chosen, found, sheet, made).write(folder / "valve_design.html")
    for front in fronts:
        factor = distance_to(front, sheet.step_time, sheet.force)
        print(
            f"{front.method:11} {len(front.forces):4} designs of {front.evaluations} evaluations, "
            f"{front.forces.min():.1f} to {front.forces.max():.1f} N over "
            f"{front.step_times.min() * 1e3:.1f} to {front.step_times.max() * 1e3:.1f} ms; "
            f"the data sheet's could be better in both by {factor:.2f}"
        )
    for name, one in (("chosen", found), ("data sheet", sheet)):
        print(
            f"{name:11} {one.step_time * 1e3:.2f} ms, {one.force:.1f} N, "
            f"overshoot {one.overshoot * 1e-5:.1f} bar"
        )
    print(f"page: {page}")
    if options.json:
        numbers = {
            front.method: {
                "designs": front.designs.tolist(),
                "step_times": front.step_times.tolist(),
                "forces": front.forces.tolist(),
            }
            for front in fronts
        }
        write_json(options.json, numbers)
    return 0
