"""Latency of the rig bridge in wall time at 1 kHz, with the emulated rig as a process of its own.

    python benchmarks/rig_link.py --seconds 60 --json rig_link.json

Each row: a link; p50, p99 and largest time from a measurement's arrival to its command on the wire,
ticks later than 1 ms, frames lost, and the longest gap between two arrivals. No node takes part:
this is the bridge's own share. Watchdogs are widened, so that a pause of a machine without real
time is measured in place of ending the run.
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

import rig_bridge
from rig_bridge.bridge import Bridge
from rig_bridge.rig_file import load_rig
from rig_bridge.safety.machine import State
from rig_bridge.transport.can_hub import CanHub
from rig_bridge.transport.registry import open_link

RIGS = Path(rig_bridge.__file__).parent / "rigs"
PATIENT = {"stale_ticks": 900, "bad_frames": 900.0, "clock_offset_s": 1.0}


def measure(kind: str, settings: dict[str, Any], seconds: float, folder: Path) -> dict[str, Any]:
    """Return the bridge's report over ``seconds`` on one link."""
    table = load_rig(RIGS / "emulated.yaml")
    table = table.model_copy(update={"watching": table.watching.model_copy(update=PATIENT)})
    own = folder / "emulator.yaml"
    own.write_text((RIGS / "emulator.yaml").read_text() + "\nstale_ticks: 900\n")
    command = [sys.executable, "-m", "rig_bridge.emulator.main", "--link", kind]
    command += ["--emulator", str(own)]
    command += [f"--setting={name}={value}" for name, value in settings.items()]
    link = open_link(kind, table, RIGS, settings)
    emulator = subprocess.Popen(command, stdout=subprocess.PIPE, text=True)
    try:
        return _run(Bridge(table, link), emulator, seconds)
    finally:
        emulator.terminate()
        emulator.communicate(timeout=10.0)
        link.close()


def _run(bridge: Bridge, emulator: subprocess.Popen[str], seconds: float) -> dict[str, Any]:
    asked = dict.fromkeys(bridge.rig.commanded, 0.0)
    until, last, gap = float("inf"), 0, 0
    while time.monotonic() < until:
        if emulator.poll() is not None:
            raise SystemExit("the emulated rig has ended")
        bridge.receive(0.1)
        reply = bridge.answer(asked)
        if reply.state is State.SAFE:
            raise SystemExit(f"the guard made the rig safe: {bridge.guard.fault}")
        if reply.state is State.RUNNING and until == float("inf"):
            until = time.monotonic() + seconds
            bridge.latency.reset()
        elif until < float("inf"):
            gap = max(gap, bridge.arrived_ns - last)
        last = bridge.arrived_ns
    return {**bridge.report(), "longest_gap": gap * 1e-9}


def main() -> None:
    """Measure each link and print a row for it."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0] if __doc__ else None)
    parser.add_argument("--seconds", type=float, default=20.0)
    parser.add_argument("--json", type=Path)
    arguments = parser.parse_args()
    rows = {}
    hub = CanHub()
    bus = {"interface": "socketcand", "channel": "can0", "host": "127.0.0.1", "port": hub.port}
    with tempfile.TemporaryDirectory() as folder:
        for kind, settings in (("udp", {}), ("can", bus)):
            row = rows[kind] = measure(kind, settings, arguments.seconds, Path(folder))
            p50, p99, most = (row[name] * 1e6 for name in ("p50", "p99", "max"))
            late = 100.0 * row["late"] / max(row["ticks"], 1)
            print(f"{kind}: p50 {p50:.0f} us, p99 {p99:.0f} us, max {most:.0f} us", flush=True)
            print(f"  late {late:.3f} % of {row['ticks']}, lost {row['lost_frames']}", end="")
            print(f", longest gap {row['longest_gap'] * 1e3:.1f} ms")
    hub.close()
    if arguments.json:
        arguments.json.write_text(json.dumps(rows, indent=1))


if __name__ == "__main__":
    main()
