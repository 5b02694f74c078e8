"""``steer diagnose-emps``: the engine on a real machine, a public benchmark's axis."""

from __future__ import annotations

import argparse
from pathlib import Path

from steering_bringup.outputs import write_json

EXAMPLES = """example:
  steer diagnose-emps FOLDER          with DATA_EMPS.mat and DATA_EMPS_PULSES.mat in it

The records are those of the EMPS benchmark (Janot, Gautier, Brunot 2019); they are not part of the
project. Written are page.html, report.json and extended_model.yaml, by the library that takes any
machine (docs/own_machine.md)."""


def arguments(parser: argparse.ArgumentParser) -> None:
    """Declare the options."""
    add = parser.add_argument
    add("folder", metavar="FOLDER", type=Path, help="folder of both records")
    add("--out", metavar="DIR", type=Path, help="folder (default: results/emps-1, -2, ...)")
    add("--json", metavar="FILE", type=Path, help="write report and errors for machines")


def execute(options: argparse.Namespace) -> int:
    """Diagnose both records, print verdicts and the published errors beside ours."""
    from steering_bringup.checks import free_folder
    from steering_bringup.outputs import check_folder
    from steering_bringup.session import make_folder
    from steering_diagnosis.emps.data import ESTIMATION, PULSES
    from steering_diagnosis.emps.diagnose_axis import PUBLISHED, diagnose_axis
    from steering_diagnosis.emps.page import write_page
    from steering_diagnosis.engine.reporting import to_report
    from steering_diagnosis.report import Source

    folder = options.out or free_folder(Path("results"), "emps")
    check_folder(folder)
    made = diagnose_axis(options.folder)
    make_folder(folder)
    library, page = write_page(options.folder, folder)
    reports = {
        name: to_report(findings, Source(path=name, sha256=""), "")
        for name, findings in ((ESTIMATION, made.findings), (PULSES, made.pulses))
    }
    for name, report in reports.items():
        print(f"{name}: {report.verdict}. {report.sentence}")
        for cause in report.causes:
            for parameter, e in cause.parameters.items():
                span = f"{e.low:.3g} to {e.high:.3g} {e.unit}"
                print(f"  {cause.effect}: {parameter} {e.value:.3g} ({span})")
        for part in report.unexplained:
            print(f"  unexplained: {part.band_hz[0]:.3g} to {part.band_hz[1]:.3g} Hz, "
                  f"{part.region}")  # fmt: skip
    for name, error in made.errors.items():
        print(f"relative force error, {name}: {100.0 * error:.2f} %")
    for name, error in PUBLISHED.items():
        print(f"  published, {name}: {100.0 * error:.2f} %")
    print(f"by the library alone: {library}")
    print(f"page: {page}")
    if options.json:
        numbers = {
            "reports": {name: r.model_dump(mode="json") for name, r in reports.items()},
            "relative_errors": made.errors,
            "published": PUBLISHED,
        }
        write_json(options.json, numbers)
    return 0
