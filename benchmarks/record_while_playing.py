"""A run recorded at 1 kHz in real time while a bag is played to a subscriber: what gets lost?

    steer bench record_while_playing                              20 s
    steer python benchmarks/record_while_playing.py --seconds 600

Every message is counted by its tick: those of the run in the bag that was recorded, those of the
playback at a subscriber. 600 s need 0.6 GB on the disk.
"""

from __future__ import annotations

import argparse
import json
import os
import subprocess
import sys
import tempfile
from contextlib import suppress
from pathlib import Path
from typing import Any

import numpy as np

from steering_bringup.bags import read_bag
from steering_bringup.benchmarking.program import Measured, main
from steering_bringup.errors import BenchError
from steering_lockstep.domain import claim_domain
from steering_lockstep.topics import TABLE

STEER = (sys.executable, "-m", "steering_bringup.cli")
RUN = ("run", "on_centre", "--node-set", "closed_centre", "--no-truth")
LISTENER = Path(__file__).with_name("_played_listener.py")
PLAYED_SECONDS = 10
HEARD = ("/steering/torque", "/driver/torque", "/vehicle/rack_force")


def played_and_recorded(seconds: float, folder: Path) -> dict[str, Any]:
    """Play, listen and record for ``seconds``; return counts and delays."""
    _steer(*RUN, "--direct", "--duration", str(PLAYED_SECONDS), "--out", str(folder / "played"))
    claim = claim_domain()
    environment = {**os.environ, "ROS_DOMAIN_ID": str(claim.number)}
    listener = subprocess.Popen(
        [sys.executable, str(LISTENER), str(PLAYED_SECONDS * 1000), *HEARD],
        env=environment,
        stdout=subprocess.PIPE,
        text=True,
    )
    assert listener.stdout is not None
    listener.stdout.readline()
    waits = [word for topic in HEARD for word in ("--wait-for", topic)]
    words = ["play", str(folder / "played" / "closed_centre"), "--loop", *waits]
    player = subprocess.Popen(
        [*STEER, *words, "--domain", str(claim.number), "--json", str(folder / "played.json")],
        stdout=subprocess.DEVNULL,
    )
    try:
        words = ["--real-time", "--duration", f"{seconds:g}", "--out", str(folder / "recorded")]
        _steer(*RUN, *words, "--json", str(folder / "recorded.json"))
    finally:
        heard = _end(player, listener)
        claim.release()
    return {
        "seconds": seconds,
        "recorded": _recorded(folder, round(seconds * 1000)),
        "played": {"listener": heard, **_summary(folder / "played.json")},
    }


def _steer(*words: str) -> None:
    status = subprocess.call([*STEER, *words], stdout=subprocess.DEVNULL)
    if status:
        raise BenchError(f"steer {words[0]} ended with status {status}")


def _end(player: subprocess.Popen[Any], listener: subprocess.Popen[str]) -> Any:
    """End playing, then listening; return what was heard."""
    if player.poll() is not None:
        print(f"the playback ended by itself, with status {player.returncode}", file=sys.stderr)
    player.terminate()
    player.wait(30)
    listener.terminate()
    try:
        out, _ = listener.communicate(timeout=30)
    except subprocess.TimeoutExpired:
        listener.kill()
        out, _ = listener.communicate()
    with suppress(ValueError):
        return json.loads(out)
    return {}


def _recorded(folder: Path, ticks: int) -> dict[str, Any]:
    """Return how many messages the recorded bag lacks, topic by topic, and the run's latency."""
    trace = read_bag(folder / "recorded" / "closed_centre")
    missing = {}
    for topic, rows in trace.topics.items():
        expected = np.arange(0, ticks, TABLE[topic].every)
        have = rows["tick"] if "tick" in (rows.dtype.names or ()) else rows["stamp"] // 1_000_000
        missing[topic] = len(np.setdiff1d(expected, have.astype(np.int64)))
    run = json.loads((folder / "recorded.json").read_text())["runs"][0]
    return {"messages": trace.message_count, "missing": missing, "latency": run["latency"]}


def _summary(file: Path) -> dict[str, Any]:
    content = json.loads(file.read_text())
    return {name: content[name] for name in ("messages", "passes", "wall_time", "lateness")}


def show(result: dict[str, Any]) -> None:
    """Print the delays."""
    latency, late = result["recorded"]["latency"], result["played"]["lateness"]
    print(f"recorded: {_times(latency)}, {latency['overruns']} of {latency['ticks']} ticks late")
    print(f"played:   late by {_times(late)}")


def _times(values: dict[str, float]) -> str:
    return ", ".join(f"{name} {1e3 * values[name]:.2f} ms" for name in ("p50", "p99", "max"))


def measure(options: argparse.Namespace) -> Measured:
    """Play, record and count; BenchError where nothing was heard."""
    with tempfile.TemporaryDirectory() as folder:
        result = played_and_recorded(options.seconds, Path(folder))
    heard = result["played"]["listener"].values()
    if not heard:
        raise BenchError("the subscriber of the playback did not answer")
    show(result)
    missing = sum(result["recorded"]["missing"].values())
    values = {
        "lost": missing + sum(topic["lost"] for topic in heard),
        "recorded": result["recorded"]["messages"],
        "heard": sum(topic["received"] for topic in heard),
    }
    return Measured(values, result)


def arguments(parser: argparse.ArgumentParser) -> None:
    """Declare the size."""
    parser.add_argument("--seconds", type=float, default=20.0, help="(default: 20)")


if __name__ == "__main__":
    sys.exit(main("record_while_playing", measure, arguments, __doc__))
