"""A run recorded at 1 kHz in real time while a bag is played to a subscriber: what gets lost?

    python benchmarks/record_while_playing.py --seconds 600 --json record_while_playing.json

Every message is counted by its tick: those of the run in the bag that was recorded, those of the
playback at a subscriber. Target: nothing is missing, over 600 s; without an option the run is 20 s
long. 600 s need 0.6 GB on the disk.
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
from steering_lockstep.domain import claim_domain
from steering_lockstep.topics import TABLE

STEER = (sys.executable, "-m", "steering_bringup.cli")
RUN = ("run", "on_centre", "--node-set", "closed_centre", "--no-truth")
LISTENER = Path(__file__).with_name("_played_listener.py")
PLAYED_SECONDS = 10
HEARD = ("/steering/torque", "/driver/torque", "/vehicle/rack_force")


def measure(seconds: float, folder: Path) -> dict[str, Any]:
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
        "target_lost": 0,
        "load_average": os.getloadavg()[0],
    }


def _steer(*words: str) -> None:
    subprocess.run([*STEER, *words], check=True, stdout=subprocess.DEVNULL)


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
    """Print the counts and delays."""
    recorded, played = result["recorded"], result["played"]
    latency, late = recorded["latency"], played["lateness"]
    missing = sum(recorded["missing"].values())
    heard = played["listener"].values()
    received, lost = (sum(topic[name] for topic in heard) for name in ("received", "lost"))
    print(f"recorded  {recorded['messages']} messages in {result['seconds']:g} s, {missing} lost")
    print(f"  latency {_times(latency)}, {latency['overruns']} of {latency['ticks']} ticks late")
    print(f"played    {played['messages']} messages; subscriber: {received}, {lost} lost")
    print(f"  late    {_times(late)}")
    print(f"lost      {result['lost']} (target 0)", flush=True)


def _times(values: dict[str, float]) -> str:
    return ", ".join(f"{name} {1e3 * values[name]:.2f} ms" for name in ("p50", "p99", "max"))


def main() -> int:
    """Measure; status 0 if nothing was lost."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--json", type=Path, metavar="FILE", help="write the numbers there")
    parser.add_argument("--seconds", type=float, default=20.0, help="(default: 20)")
    options = parser.parse_args()
    with tempfile.TemporaryDirectory() as folder:
        result = measure(options.seconds, Path(folder))
    heard = result["played"]["listener"]
    result["lost"] = sum(result["recorded"]["missing"].values())
    result["lost"] += sum(topic["lost"] for topic in heard.values())
    show(result)
    if options.json:
        options.json.write_text(json.dumps(result, indent=2) + "\n", encoding="utf-8")
    return 0 if heard and not result["lost"] else 1


if __name__ == "__main__":
    raise SystemExit(main())
