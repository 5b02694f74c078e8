"""A drawn fleet: all with a stiffer torsion bar than the data sheet, three with a leak.

    steer bench fleet
    steer python benchmarks/fleet.py --specimens 50 --records fleet_records

Each specimen is drawn within the tolerances by the sealed benchmark's own generator, then its bar
is made stiffer, and the first ones get a leak across the piston. Found is what is common, and what
one specimen has alone. A second run with the same folder goes on where the first one stopped.
"""

from __future__ import annotations

import argparse
import sys
import tempfile
from pathlib import Path
from typing import Any

import numpy as np

from steering_bringup.benchmarking.program import Measured, main
from steering_core.parameters import load_parameters
from steering_diagnosis.benchmark.truth.course import draw_course
from steering_diagnosis.benchmark.truth.disturbance import RESOLUTION, disturbance
from steering_diagnosis.benchmark.truth.effects import changed
from steering_diagnosis.benchmark.truth.run import run_closed_loop
from steering_diagnosis.benchmark.truth.specimen import draw_specimen

BAR, LEAK = "torsion_bar_stiffness", "cross_piston_leakage"
PARAMETER = "mechanics.torsion_bar_stiffness"
SYSTEM = "closed_centre"
DRIVES = ("sweep", "chirp", "weave", "ramps", "steps", "amplitudes")
FIRST_SEED = 800_000


def write_specimen(seed: int, sizes: dict[str, float], seconds: float, path: Path) -> None:
    """Write the record of one specimen as CSV in SI, with all measured channels."""
    import pandas as pd

    from steering_diagnosis.benchmark.bags import channels_of

    random = np.random.default_rng(seed)
    nominal = load_parameters()
    course = draw_course(random, seconds, str(random.choice(DRIVES)), "table")
    specimen = changed(draw_specimen(nominal, random), nominal, SYSTEM, sizes)
    noise = disturbance(random, len(course.angle))
    signals = run_closed_loop(specimen, nominal, course, True, noise, RESOLUTION)
    channels = channels_of(signals, SYSTEM)
    time = np.arange(len(course.angle)) * 1e-3
    pd.DataFrame({"time": time, **channels}).to_csv(path, index=False, float_format="%.9g")


def measure(options: argparse.Namespace) -> Measured:
    """Draw the fleet, diagnose it, count what is right."""
    with tempfile.TemporaryDirectory() as made:
        folder = options.records or Path(made)
        return _measured(options, folder)


def _measured(options: argparse.Namespace, folder: Path) -> Measured:
    import yaml

    from steering_diagnosis.data.channels import CHANNELS
    from steering_diagnosis.fleet.run import diagnosed
    from steering_diagnosis.fleet.telling import lines
    from steering_diagnosis.fleet.verdict import judged
    from steering_studies.parallel import pool

    folder.mkdir(parents=True, exist_ok=True)
    records, leaky = {}, set()
    for k in range(options.specimens):
        name = f"specimen_{k + 1:02d}"
        sizes = {BAR: options.stiffer}
        if k < options.leaks:
            sizes[LEAK] = options.leak
            leaky.add(name)
        records[name] = folder / f"{name}.csv"
        if not records[name].exists():
            write_specimen(FIRST_SEED + k, sizes, options.seconds, records[name])
    mapping = folder / "mapping.yaml"
    columns = records["specimen_01"].read_text().partition("\n")[0].split(",")[1:]
    channels = {n: {"from": n, "unit": CHANNELS[n].unit} for n in columns}
    mapping.write_text(
        yaml.safe_dump({"schema": 1, "valve_system": SYSTEM, "time": "time", "channels": channels})
    )
    with pool(options.jobs) as executor:
        reports, failed = diagnosed(records, mapping, folder, executor)
    fleet = judged(reports)
    print("\n".join(lines(fleet, failed)))
    bar = next(s for s in fleet.shifts if s.name == PARAMETER)
    right = {n for n, causes in fleet.single.items() if n in leaky and causes == (LEAK,)}
    others = [c for c in fleet.common if c != BAR]
    others += [s.name for s in fleet.shifted if s.name != PARAMETER]
    details: dict[str, Any] = {"single": dict(fleet.single), "common": list(fleet.common)}
    return Measured(
        {
            "bar": float(bar.common or BAR in fleet.common),
            "bar_value": 100.0 * (bar.value / bar.nominal - 1.0),
            "leaks": 100.0 * len(right) / max(len(leaky), 1),
            "wrong_single": float(len(set(fleet.single) - right)),
            "wrong_common": float(len(others)),
            "failed": float(len(failed)),
        },
        details,
    )


def arguments(parser: argparse.ArgumentParser) -> None:
    """Declare the size."""
    add = parser.add_argument
    add("--specimens", type=int, default=50)
    add("--leaks", type=int, default=3, help="specimens with a leak")
    add("--stiffer", type=float, default=0.05, help="share by which all bars are stiffer")
    add("--leak", type=float, default=4e-12, help="m3/(s Pa)")
    add("--seconds", type=float, default=15.0)
    add("--records", type=Path, help="keep records and reports here, and go on there")
    add("--jobs", type=int, default=2)


if __name__ == "__main__":
    sys.exit(main("fleet", measure, arguments, __doc__))
