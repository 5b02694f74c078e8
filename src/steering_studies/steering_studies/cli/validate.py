"""``steer validate``: a model against a recorded system test."""

from __future__ import annotations

import argparse
from pathlib import Path

from steering_bringup.outputs import write_json

EXAMPLES = """examples:
  steer validate results/rig_test-1/system
  steer validate rig/system --parameter-set mine/my_gear.yaml --boost-curve mine/boost_curve.csv"""


def arguments(parser: argparse.ArgumentParser) -> None:
    """Declare the options."""
    add = parser.add_argument
    add("bag", metavar="BAG", type=Path, help="bag of a system test")
    add("--parameter-set", metavar="SET", default="nominal", help="name or YAML file")
    add("--boost-curve", metavar="CSV", type=Path, help="measured boost curve, not the formula")
    add("--set", metavar="NAME=VALUE", action="append", default=[], help="a parameter; repeatable")
    add("--valve-system", choices=("open_centre", "closed_centre"), default="open_centre")
    add("--out", metavar="DIR", type=Path, help="folder (default: results/validation-1, -2, ...)")
    add("--json", metavar="FILE", type=Path, help="write the figures of merit for machines")


def execute(options: argparse.Namespace) -> int:
    """Simulate, compare, write the page, print the figures of merit."""
    from dataclasses import asdict

    from steering_bringup.bags import read_bag
    from steering_bringup.checks import free_folder
    from steering_core.parameters import load_parameters
    from steering_plant.measured_boost_curve import read_boost_curve
    from steering_studies.channels import from_bag
    from steering_studies.pages.validation import validation_page
    from steering_studies.settings import parameters_of
    from steering_studies.validation import validate

    parameters = load_parameters(options.parameter_set).with_values(parameters_of(options.set))
    curve = None if options.boost_curve is None else read_boost_curve(str(options.boost_curve))
    made = validate(
        from_bag(read_bag(options.bag, repair_damage=False)),
        parameters,
        options.valve_system,
        curve,
    )
    folder = options.out or free_folder(Path("results"), "validation")
    page = validation_page(made, options.bag.name).write(folder / "validation.html")
    for name, found in made.merits.items():
        print(f"{name:22} rms {found.rms:9.4g} {found.unit:4} fit {100.0 * found.fit:6.2f} %")
    print(f"page: {page}")
    if options.json:
        numbers = {name: asdict(found) for name, found in made.merits.items()}
        write_json(options.json, numbers)
    return 0
