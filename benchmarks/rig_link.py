"""Latency of the rig bridge in wall time at 1 kHz, with the emulated rig as a process of its own.

    steer bench rig_link                                       20 s each
    steer python benchmarks/rig_link.py --minutes 5            the full one
    steer python benchmarks/rig_link.py --ways graph --links can --processes one

Each row: the bridge alone or the whole ROS graph (driver, controllers, vehicle, recorder), and a
link; p50, p99 and largest time from a measurement's arrival to its command on the wire; the share
of late ticks, which are those later than 1 ms and those answered with an old command, beside the
target; the same share counted from the measurement by the rig's clock, where a pause of the
emulated rig itself counts too; frames lost. Watchdogs are widened, so that a pause of a machine
without real time is measured in place of ending the run.
"""

from __future__ import annotations

import argparse
import json
import subprocess
import sys
import tempfile
import time
from pathlib import Path
from typing import Any

import yaml

from rig_bridge.emulated import emulated
from rig_bridge.rig_file import load_rig
from rig_bridge.session import Session
from rig_bridge.shipped import find_rig
from rig_bridge.transport.registry import open_link
from steering_lockstep.signals import PLACES
from steering_lockstep.urgency import PRIORITY, hurry

TARGET = 1e-3
PATIENT = {
    "stale_ticks": 900,
    "command_stale_ticks": 900,
    "bad_frames": 900.0,
    "clock_offset_s": 1.0,
}
REST_FORCE_N, REST_PRESSURE_PA = 14.0, 6e5


def patient_rig(folder: Path) -> Path:
    """Write the shipped rig with wide watchdogs to ``folder`` and return its file."""
    shipped = find_rig("emulated")
    own = yaml.safe_load(shipped.with_name("emulator.yaml").read_text()) | {"stale_ticks": 900}
    (folder / "emulator.yaml").write_text(yaml.safe_dump(own))
    (folder / "emulated.dbc").write_bytes(shipped.with_name("emulated.dbc").read_bytes())
    rig = yaml.safe_load(shipped.read_text()) | {"watching": PATIENT, "relations": {}, "rates": {}}
    for channel in rig["channels"].values():
        if channel["direction"] == "measured":
            channel["rate"] = 1e12
    path = folder / "emulated.yaml"
    path.write_text(yaml.safe_dump(rig, sort_keys=False))
    return path


def bare(path: Path, link: str, seconds: float) -> dict[str, Any]:
    """Return the report of the bridge alone: constant commands, no node, no ROS."""
    rig = load_rig(path)
    rest = [_rest(name) for name in rig.commanded]
    columns = [PLACES[name] for name in rig.commanded]
    with emulated(path, rig, link, PRIORITY) as (settings, _):
        session = Session(rig, columns, lambda: open_link(link, rig, path.parent, settings))
        hurry(["rig_bridge"])
        session.open()
        ticks, until = 0, time.monotonic() + seconds + 30.0
        while ticks < seconds * 1000 and time.monotonic() < until:
            ticks += len(session.receive())
            session.answer(ticks, rest, 0, None)
            if session.failure:
                raise SystemExit(session.failure)
        session.close()
        return session.report()


def _rest(name: str) -> float:
    if name.endswith("solenoid_force"):
        return REST_FORCE_N
    return REST_PRESSURE_PA if name.endswith("reference_pressure") else 0.0


def graph(path: Path, link: str, seconds: float, processes: str | None) -> dict[str, Any]:
    """Return the report of a recorded run through the ROS graph."""
    with tempfile.TemporaryDirectory() as folder:
        file = Path(folder, "run.json")
        words = ["run", "weave", "--node-set", "closed_centre", "--plant", "rig"]
        words += ["--rig", str(path), "--rig-link", link, "--duration", f"{seconds:g}"]
        words += ["--out", str(Path(folder, "out")), "--json", str(file)]
        words += ["--processes", processes] if processes else []
        command = [sys.executable, "-m", "steering_bringup.cli", *words]
        done = subprocess.run(command, stdout=subprocess.DEVNULL, check=False)
        if done.returncode:
            raise SystemExit(done.returncode)
        run = json.loads(file.read_text())["runs"][0]
    return run["rig"] | {"recorded": run["messages"], "recording_lost": sum(run["lost"].values())}


def row(way: str, link: str, report: dict[str, Any]) -> str:
    """Return a line of the table."""
    p50, p99, most = (report[name] * 1e6 for name in ("p50", "p99", "max"))
    late, since = share(report), share(report["since_measured"])
    verdict = "" if late < TARGET else "  above the target"
    return (
        f"{way:6} {link:4} {p50:7.0f} {p99:7.0f} {most:8.0f} {100 * late:8.3f} {100 * since:10.3f}"
        f" {report['lost_frames']:6}{verdict}"
    )


def share(latency: dict[str, Any]) -> float:
    """Return the share of late ticks."""
    return float(latency["late"] / max(latency["ticks"], 1))


def main() -> None:
    """Measure each way over each link; status 1 where a share is above the target."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0] if __doc__ else None)
    add = parser.add_argument
    add("--seconds", type=float, default=20.0, help="of each row (default: 20)")
    add("--minutes", type=float, help="of each row, in place of --seconds")
    add("--links", nargs="+", choices=("udp", "can"), default=["udp", "can"])
    add("--ways", nargs="+", choices=("graph", "bare"), default=["graph", "bare"])
    add("--processes", choices=("one", "each"), help="layout of the graph (default: a rig's)")
    add("--json", type=Path)
    options = parser.parse_args()
    seconds = options.seconds if options.minutes is None else 60.0 * options.minutes
    print(f"{seconds:g} s each; times in us, late ticks in % (target {100 * TARGET:g})")
    print("way    link     p50     p99      max     late  since rig   lost", flush=True)
    rows: dict[str, Any] = {}
    with tempfile.TemporaryDirectory() as folder:
        path = patient_rig(Path(folder))
        for way in options.ways:
            for link in options.links:
                report = (
                    bare(path, link, seconds)
                    if way == "bare"
                    else graph(path, link, seconds, options.processes)
                )
                rows[f"{way}_{link}"] = report | {"late_share": share(report)}
                print(row(way, link, report), flush=True)
    if options.json:
        options.json.write_text(json.dumps(rows, indent=1))
    raise SystemExit(any(entry["late_share"] >= TARGET for entry in rows.values()))


if __name__ == "__main__":
    main()
