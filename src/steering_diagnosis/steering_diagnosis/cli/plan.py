"""``steer plan``: the experiment that separates what a diagnosis could not."""

from __future__ import annotations

import argparse
import os
from pathlib import Path

from steering_bringup.outputs import write_json, write_text

EXAMPLES = """example:
  steer plan results/diagnosis-1/report.json --out next.yaml
  steer run next.yaml"""


def arguments(parser: argparse.ArgumentParser) -> None:
    """Declare the options."""
    add = parser.add_argument
    add("report", metavar="REPORT", type=Path, help="report.json of a diagnosis, or its folder")
    add("--out", metavar="FILE", type=Path, default=Path("next.yaml"), help="(default: next.yaml)")
    add("--jobs", metavar="N", type=int, default=os.cpu_count() or 1, help="processes")
    add("--json", metavar="FILE", type=Path, help="write the scores for machines")


def execute(options: argparse.Namespace) -> int:
    """Choose the experiment, write it as a scenario, tell why."""
    import yaml

    from steering_bringup.progress import Steps
    from steering_core.errors import BenchError
    from steering_diagnosis.planning.plan import plan
    from steering_diagnosis.writing import read_report
    from steering_studies.parallel import pool

    report = read_report(options.report)
    if options.out.exists():
        raise BenchError(f"'{options.out}' exists already: another --out")
    with pool(options.jobs) as executor, Steps("plan") as progress:
        chosen = plan(report, report.valve_system, executor=executor, progress=progress)
    head = f"# The experiment that {chosen.purpose}: {chosen.score:.2g} times the sensors' noise.\n"
    text = head + yaml.safe_dump(chosen.document, sort_keys=False)
    write_text(options.out, text)
    for name, score in sorted(chosen.scores.items(), key=lambda item: -item[1]):
        print(f"  {name:18} {score:8.3g} times the noise")
    print(f"{chosen.document['name']} {chosen.purpose}")
    print(f"scenario: {options.out}  (steer run {options.out})")
    if options.json:
        write_json(options.json, {"scores": chosen.scores})
    return 0
