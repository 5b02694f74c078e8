"""``steer diagnose``: what the simulation gets wrong on a record, and why."""

from __future__ import annotations

import argparse
import os
import shlex
from pathlib import Path

from steering_bringup.outputs import write_text

EXAMPLES = """examples:
  steer diagnose results/on_centre-1/open_centre
  steer diagnose rig/monday --holdout rig/tuesday --out results/monday
  steer diagnose drive.mf4 --mapping drive.yaml --from 12 --to 52
  steer diagnose monday.csv --model oven.fmu --mapping oven.yaml --holdout tuesday.csv

The data are a bag of the bench or of the rig bridge, or a CSV, MATLAB or MDF4 file with a mapping
file. Written are report.html, report.json, and extension.yaml for 'steer run --set-file'.

With --model an FMU of any machine is diagnosed: docs/own_machine.md. Written are page.html,
report.json and extended_model.yaml."""


def arguments(parser: argparse.ArgumentParser) -> None:
    """Declare the options."""
    add = parser.add_argument
    add("data", metavar="DATA", type=Path, help="bag, or file with --mapping")
    add("--holdout", metavar="DATA", type=Path, help="a manoeuvre that takes no part in the fit")
    add("--mapping", metavar="FILE", type=Path, help="what the channels of a foreign file are")
    add("--model", metavar="FMU", type=Path, help="a model of another tool, in place of the gear")
    add("--from", metavar="S", type=float, dest="start", help="s from the record's beginning")
    add("--to", metavar="S", type=float, dest="stop", help="s from the record's beginning")
    add("--out", metavar="DIR", type=Path, help="folder (default: results/diagnosis-1, -2, ...)")
    add(
        "--jobs",
        metavar="N",
        type=int,
        default=os.cpu_count() or 1,
        help="processes (default: all)",
    )
    add("--json", metavar="FILE", type=Path, help="write report.json here as well")


def execute(options: argparse.Namespace) -> int:
    """Read, diagnose, write the report, tell the verdict."""
    from steering_bringup.checks import free_folder
    from steering_bringup.outputs import check_folder
    from steering_bringup.session import make_folder
    from steering_diagnosis.data.cut import cut
    from steering_diagnosis.data.read import read_record
    from steering_diagnosis.running import run_diagnosis
    from steering_diagnosis.writing import tell, write_all

    folder = options.out or free_folder(Path("results"), "diagnosis")
    check_folder(folder)
    if options.model is not None:
        return _foreign(options, folder)
    record = cut(read_record(options.data, options.mapping), options.start, options.stop)
    holdout = None
    if options.holdout is not None:
        holdout = cut(read_record(options.holdout, options.mapping), None, None)
    make_folder(folder)
    diagnosis = run_diagnosis(record, holdout, options.jobs)
    files = write_all(diagnosis, folder)
    if options.json:
        write_text(options.json, (folder / "report.json").read_text("utf-8"))
    print("\n".join(tell(diagnosis, files)))
    return 0


def _foreign(options: argparse.Namespace, folder: Path) -> int:
    """Diagnose a model of another tool."""
    from steering_bringup.session import make_folder
    from steering_diagnosis.foreign_model import diagnose_fmu, tell

    part = (options.start, options.stop)
    found, notes = diagnose_fmu(options.model, options.mapping, options.data, options.holdout, part)
    make_folder(folder)
    page = found.write(folder, call=_called(options))
    if options.json:
        write_text(options.json, (folder / "report.json").read_text("utf-8"))
    print("\n".join(tell(found, page, notes)))
    return 0


def _called(options: argparse.Namespace) -> str:
    """Return the command, as it is written."""
    words = ["./steer", "diagnose", str(options.data)]
    for name, value in (
        ("model", options.model),
        ("mapping", options.mapping),
        ("holdout", options.holdout),
        ("from", options.start),
        ("to", options.stop),
    ):
        words += [] if value is None else [f"--{name}", str(value)]
    return shlex.join(words)
