"""``steer fleet``: several specimens: what the model gets wrong in all, and what one has alone."""

from __future__ import annotations

import argparse
import os
from pathlib import Path

from steering_bringup.outputs import write_json, write_text

EXAMPLES = """examples:
  steer fleet records/ --out results/spring
  steer fleet monday.csv tuesday.csv wednesday.csv --mapping rig.yaml --jobs 8

DATA are bags, files with --mapping, or folders of these: one record a specimen, at least two.
Written are NAME/report.json of each, fleet.json, and fleet.yaml for 'steer run --set-file' where
something is common. A second run into the same folder goes on where the first one stopped."""


def arguments(parser: argparse.ArgumentParser) -> None:
    """Declare the options."""
    add = parser.add_argument
    add("data", metavar="DATA", type=Path, nargs="+", help="records, or folders of records")
    add("--mapping", metavar="FILE", type=Path, help="what the channels of foreign files are")
    add("--out", metavar="DIR", type=Path, help="folder (default: results/fleet-1, -2, ...)")
    add("--jobs", metavar="N", type=int, default=os.cpu_count() or 1, help="processes")
    add("--json", metavar="FILE", type=Path, help="write fleet.json here as well")


def execute(options: argparse.Namespace) -> int:
    """Diagnose each, judge them together, tell and write it."""
    import yaml

    from steering_bringup.checks import free_folder
    from steering_bringup.progress import Steps
    from steering_core.errors import BenchError
    from steering_diagnosis.fleet import telling
    from steering_diagnosis.fleet.run import diagnosed, found_in
    from steering_diagnosis.fleet.verdict import judged
    from steering_studies.parallel import pool

    records = found_in(options.data)
    if len(records) < 2:
        raise BenchError(f"one record is no fleet: 'steer diagnose {next(iter(records.values()))}'")
    folder = options.out or free_folder(Path("results"), "fleet")
    folder.mkdir(parents=True, exist_ok=True)
    done: list[str] = []
    with pool(options.jobs) as executor, Steps("fleet") as progress:

        def tell(name: str) -> None:
            done.append(name)
            progress(len(done) / len(records), name)

        reports, failed = diagnosed(records, options.mapping, folder, executor, tell)
    if len(reports) < 2:
        why = "; ".join(f"{name}: {text}" for name, text in failed.items())
        raise BenchError(f"fewer than two specimens could be judged: {why}")
    fleet = judged(reports)
    files = [folder / "fleet.json"]
    write_json(files[0], telling.document(fleet, failed))
    if extension := telling.extension(fleet, reports):
        files.append(folder / "fleet.yaml")
        head = f"# What {len(reports)} specimens have in common: ./steer run SCENARIO --set-file\n"
        write_text(files[1], head + yaml.safe_dump(extension, sort_keys=False))
    if options.json:
        write_json(options.json, telling.document(fleet, failed))
    print("\n".join(telling.lines(fleet, failed)))
    print("\n".join(f"file: {file}" for file in files))
    return 1 if failed else 0
