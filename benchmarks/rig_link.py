"""Latency of the rig bridge in wall time at 1 kHz, with the emulated rig as a process of its own.

    steer bench rig_link                                       20 s each
    steer python benchmarks/rig_link.py --minutes 5            the full one
    steer python benchmarks/rig_link.py --ways graph --links can --processes one

The bridge alone or the whole ROS graph (driver, controllers, vehicle, recorder), over each link:
the time from a measurement's arrival to its command on the wire, and the share of late ticks, which
are those later than 1 ms and those answered with an old command. The target is that share less the
one of a process that only sleeps from millisecond to millisecond meanwhile: what the machine does
to everybody is not the bridge's. Among the details is the latency from the measurement by the rig's
clock, where a pause of the emulated rig itself counts too. Watchdogs are widened, so that a pause
of a machine without real time is measured in place of ending the run.
"""

from __future__ import annotations

import argparse
import itertools
import json
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable
from functools import partial
from pathlib import Path
from typing import Any

import yaml

from rig_bridge.emulated import emulated
from rig_bridge.rig_file import load_rig
from rig_bridge.session import Session
from rig_bridge.shipped import find_rig
from rig_bridge.transport.registry import trusted_link
from steering_bringup.benchmarking.program import Measured, main
from steering_bringup.errors import BenchError
from steering_lockstep.signals import PLACES
from steering_lockstep.urgency import PRIORITY, hurry

SLEEPER = Path(__file__).with_name("_sleeper.py")
PATIENT = {
    "stale_ticks": 900,
    "command_stale_ticks": 900,
    "bad_frames": 900.0,
    "clock_offset_s": 1.0,
}
GENTLE_DEG = 5.0
"""Amplitude of the weave, small: a pause of the machine drives a loop with large torques apart."""
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
        session = Session(rig, columns, lambda: trusted_link(link, rig, path.parent, settings))
        hurry(["rig_bridge"])
        session.open()
        ticks, wanted, until = 0, round(seconds * 1000), time.monotonic() + seconds + 30.0
        while ticks < wanted and time.monotonic() < until:
            ticks += len(session.receive(wanted - ticks))
            session.answer(ticks, rest, 0, None)
            if session.failure:
                raise BenchError(session.failure)
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
        words += ["--set", f"manoeuvre.amplitude_deg={GENTLE_DEG}"]
        words += ["--rig", str(path), "--rig-link", link, "--duration", f"{seconds:g}"]
        words += ["--out", str(Path(folder, "out")), "--json", str(file)]
        words += ["--processes", processes] if processes else []
        command = [sys.executable, "-m", "steering_bringup.cli", *words]
        done = subprocess.run(command, stdout=subprocess.DEVNULL, check=False)
        if done.returncode:
            raise BenchError(f"steer run ended with status {done.returncode}")
        run = json.loads(file.read_text())["runs"][0]
    return run["rig"] | {"recorded": run["messages"], "recording_lost": sum(run["lost"].values())}


def share(latency: dict[str, Any]) -> float:
    """Return the share of late ticks."""
    return float(latency["late"] / max(latency["ticks"], 1))


def beside_a_sleeper(
    call: Callable[[], dict[str, Any]], seconds: float
) -> tuple[dict[str, Any], float]:
    """Return what ``call`` reports, and the share of late ticks of a process that only sleeps."""
    with subprocess.Popen(
        [sys.executable, str(SLEEPER), f"{seconds:g}"], stdout=subprocess.PIPE, text=True
    ) as sleeper:
        try:
            report = call()
        finally:
            sleeper.terminate()
            out, _ = sleeper.communicate(timeout=30)
    return report, share(json.loads(out))


def measure(options: argparse.Namespace) -> Measured:
    """Measure each way over each link."""
    seconds = options.seconds if options.minutes is None else 60.0 * options.minutes
    values: dict[str, float | None] = {}
    details = {}
    with tempfile.TemporaryDirectory() as folder:
        path = patient_rig(Path(folder))
        for way, link in itertools.product(options.ways, options.links):
            name, through = f"{way}_{link}", partial(bare, path, link, seconds)
            if way == "graph":
                through = partial(graph, path, link, seconds, options.processes)
            report, sleeping = beside_a_sleeper(through, seconds)
            late = share(report)
            values |= {
                f"{name}_p50": 1e6 * report["p50"],
                f"{name}_p99": 1e6 * report["p99"],
                f"{name}_late": 100.0 * late,
                f"{name}_beyond": 100.0 * (late - sleeping),
                f"{name}_lost": report["lost_frames"],
            }
            details[name] = report | {"late_share": late, "late_share_of_sleeper": sleeping}
    return Measured(values, details)


def arguments(parser: argparse.ArgumentParser) -> None:
    """Declare size and choice."""
    add = parser.add_argument
    add("--seconds", type=float, default=20.0, help="of each row (default: 20)")
    add("--minutes", type=float, help="of each row, in place of --seconds")
    add("--links", nargs="+", choices=("udp", "can"), default=["udp", "can"])
    add("--ways", nargs="+", choices=("graph", "bare"), default=["graph", "bare"])
    add("--processes", choices=("one", "each"), help="layout of the graph (default: a rig's)")


if __name__ == "__main__":
    sys.exit(main("rig_link", measure, arguments, __doc__))
