"""``steer schema``: JSON Schema of the YAML files, for editors."""

from __future__ import annotations

import argparse
import json
from pathlib import Path

EXAMPLES = """example:
  steer schema --out schemas
  then put this first line into a scenario file:
  # yaml-language-server: $schema=schemas/scenario.schema.json"""


def arguments(parser: argparse.ArgumentParser) -> None:
    """Declare the options."""
    parser.add_argument(
        "--out",
        metavar="DIR",
        type=Path,
        default=Path("schemas"),
        help="folder to write to (default: schemas)",
    )


def execute(options: argparse.Namespace) -> int:
    """Write a schema for each kind of file."""
    from rig_bridge.rig_file import RigFile
    from steering_bringup.schema import NodeSet, Scenario

    options.out.mkdir(parents=True, exist_ok=True)
    for name, model in (("scenario", Scenario), ("node_set", NodeSet), ("rig", RigFile)):
        path = options.out / f"{name}.schema.json"
        path.write_text(json.dumps(model.model_json_schema(), indent=2) + "\n", encoding="utf-8")
        print(path)
    return 0
