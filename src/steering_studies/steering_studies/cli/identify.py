"""``steer identify``: what rig tests tell of a gear, as a parameter set that loads."""

from __future__ import annotations

import argparse
from pathlib import Path

from steering_bringup.outputs import write_json

EXAMPLES = """examples:
  steer identify results/rig_test-1
  steer identify rig/boost_curve rig/stiffness --out mine --name my_gear

Written are NAME.yaml (values, tolerances), boost_curve.csv and identification.html."""


def arguments(parser: argparse.ArgumentParser) -> None:
    """Declare the options."""
    add = parser.add_argument
    add("bags", metavar="BAG", nargs="+", type=Path, help="bags of rig tests, or folders of them")
    add("--set", metavar="NAME=VALUE", action="append", default=[], help="what is known otherwise")
    add("--name", default="identified", help="of the parameter set (default: identified)")
    add("--out", metavar="DIR", type=Path, help="folder (default: results/NAME-1, -2, ...)")
    add("--json", metavar="FILE", type=Path, help="write the estimates for machines")


def execute(options: argparse.Namespace) -> int:
    """Identify, write the set and the page, print the estimates."""
    from dataclasses import asdict

    from steering_bringup.checks import free_folder
    from steering_core.parameters import load_parameters
    from steering_studies.identification.identify import identify
    from steering_studies.identification.write import write_curve, write_set
    from steering_studies.pages.rig_tests import rig_test_page
    from steering_studies.rig_tests.record import recorded
    from steering_studies.settings import parameters_of

    nominal = load_parameters().with_values(parameters_of(options.set))
    runs = recorded(options.bags)
    found = identify(runs, nominal)
    folder = options.out or free_folder(Path("results"), options.name)
    write_set(found, folder / f"{options.name}.yaml")
    if found.boost_curve is not None:
        write_curve(found.boost_curve, folder / "boost_curve.csv")
    page = rig_test_page(runs, found, nominal).write(folder / "identification.html")
    for name, e in found.estimates.items():
        print(f"{name:44} {e.value:11.4g}  {e.low:.4g} to {e.high:.4g} {e.unit}")
    for name in found.missing:
        print(f"no test '{name}': its parameters stay nominal")
    print(f"parameter set: {folder / options.name}.yaml")
    print(f"page: {page}")
    if options.json:
        numbers = {name: asdict(estimate) for name, estimate in found.estimates.items()}
        write_json(options.json, numbers)
    return 0
