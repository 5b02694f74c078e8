"""``rig_emulator``: the emulated rig as a process of its own, paced by its own clock."""

from __future__ import annotations

import argparse
import json
import os
import sys
import time
from pathlib import Path
from typing import Any

from rig_bridge.emulator.rig import PERIOD_NS, EmulatedRig
from rig_bridge.emulator.settings import EmulatorSettings, load_settings
from rig_bridge.emulator.stop import Stop
from rig_bridge.helpers import end_with_input
from rig_bridge.rig_file import RigFile, load_rig
from rig_bridge.transport.link import Link
from rig_bridge.transport.registry import TRANSPORTS, trusted_link
from steering_core.errors import BenchError
from steering_lockstep.urgency import hasten, without_pauses

SHIPPED = Path(__file__).resolve().parents[1] / "rigs"


def parser() -> argparse.ArgumentParser:
    """Return the command line's parser."""
    arguments = argparse.ArgumentParser(
        prog="rig_emulator",
        description="An emulated test rig behind a link.",
        epilog="example: rig_emulator --link udp --setting bench=127.0.0.1:47010",
    )
    arguments.add_argument("--rig", default=str(SHIPPED / "emulated.yaml"), help="the rig's file")
    arguments.add_argument(
        "--emulator", default=str(SHIPPED / "emulator.yaml"), help="its own file"
    )
    arguments.add_argument("--link", choices=sorted(TRANSPORTS), default="udp")
    arguments.add_argument("--setting", action="append", default=[], metavar="NAME=VALUE")
    arguments.add_argument("--settings", metavar="JSON", help="all settings, of several buses too")
    arguments.add_argument(
        "--attached", action="store_true", help="end when standard input is closed"
    )
    arguments.add_argument(
        "--priority", type=int, default=0, metavar="N", help="of the real-time scheduler"
    )
    arguments.add_argument("--duration", type=float, default=float("inf"), metavar="S")
    return arguments


def run(
    rig: EmulatedRig, link: Link, settings: EmulatorSettings, duration_s: float, stop: Stop
) -> None:
    """Send measurements each period of the rig's clock until ``duration_s`` or a signal."""
    period_s = PERIOD_NS * 1e-9 * (1.0 + settings.clock_drift)
    begin = time.monotonic()
    while rig.tick * period_s < duration_s and not stop.asked:
        link.send_frame(rig.measure())
        due = begin + (rig.tick + 1) * period_s
        time.sleep(max(due - time.monotonic(), 0.0))
        rig.step(link.receive_demands(0.0))


def _values(texts: list[str]) -> dict[str, Any]:
    pairs = [text.partition("=") for text in texts]
    return {name: _value(value) for name, _, value in pairs}


def _value(text: str) -> Any:
    try:
        return json.loads(text)
    except ValueError:
        return text


def _settings(arguments: argparse.Namespace) -> Any:
    try:
        return json.loads(arguments.settings) if arguments.settings else _values(arguments.setting)
    except ValueError as error:
        raise BenchError(f"--settings is no JSON: {error}") from None


def main() -> int:
    """Run the emulated rig; prints one line of JSON when it is ready and one at the end."""
    arguments = parser().parse_args()
    stop = Stop()
    if arguments.attached:
        end_with_input()
    try:
        path = Path(arguments.rig)
        table: RigFile = load_rig(path)
        settings = load_settings(arguments.emulator)
        given = _settings(arguments)
        link = trusted_link(arguments.link, table, path.parent, given, rig_end=True)
        EmulatedRig(table, settings, link.sequence_bits).step([])  # compiles before the clock runs
    except BenchError as error:
        print(f"rig_emulator: {error}", file=sys.stderr)
        return 2
    rig = EmulatedRig(table, settings, link.sequence_bits)
    if arguments.priority:
        hasten(os.getpid(), arguments.priority)
    without_pauses()  # one would be longer than the rig's own watchdog allows
    stop.listen()
    print(json.dumps({"ready": table.name}), flush=True)
    try:
        run(rig, link, settings, arguments.duration, stop)
    finally:
        stop.ignore()
        link.close()
    end = {"ticks": rig.tick, "safe": rig.watchdog.latched, "bad_packets": link.bad}
    if link.peer is not None:
        end |= {f"{why}_packets": count for why, count in link.peer.counts.items()}
    print(json.dumps(end), flush=True)
    return 0


if __name__ == "__main__":
    sys.exit(main())
