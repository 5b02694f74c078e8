"""``steer play``: publish a bag on ROS topics."""

from __future__ import annotations

import argparse
import signal
import sys
from pathlib import Path
from typing import TYPE_CHECKING, Any

from steering_bringup.cli.ros_options import add_domain, settle_domain
from steering_bringup.errors import BenchError
from steering_bringup.outputs import write_json

if TYPE_CHECKING:
    from steering_bringup.playback.playing import Played, Wish

EXAMPLES = """examples:
  steer play results/on_centre-1/closed_centre
  steer play BAG --rate 0.1 --from 5 --to 8 --loop
  steer play BAG --rate max --topics /steering/torque /steering/rack
  steer play BAG --remap /driver/torque:=/test/torque --domain 7
  steer play rig.db3 --wait-for /steering/torque --range SUBNET

keys, where standard input is a terminal:
  space  pause, and go on      s, right  pause, then step from one stamp to the next
  up     twice the rate        down      half the rate        q  end"""


def arguments(parser: argparse.ArgumentParser) -> None:
    """Declare the options."""
    add = parser.add_argument
    add("bag", metavar="BAG", type=Path, help="folder of a bag, or a .mcap or .db3 file")
    what = parser.add_argument_group("what is played")
    add = what.add_argument
    add("--topics", metavar="TOPIC", nargs="+", default=[], help="these only")
    add("--exclude", metavar="TOPIC", nargs="+", default=[], help="all but these")
    add("--from", metavar="S", dest="start", type=float, default=0.0, help="s from the beginning")
    add("--to", metavar="S", dest="stop", type=float, help="s from the beginning")
    add("--loop", action="store_true", help="again and again, until it is ended")
    how = parser.add_argument_group("how it is played")
    add = how.add_argument
    add("--rate", metavar="R", default="1", help="0.1, 2, ... times real time, or max (default: 1)")
    add(
        "--remap",
        metavar="OLD:=NEW",
        action="append",
        default=[],
        help="publish a topic under another name; repeatable",
    )
    add(
        "--clock", metavar="HZ", type=float, default=100.0, help="of /clock (default: 100, 0: none)"
    )
    add("--delay", metavar="S", type=float, default=0.5, help="for discovery (default: 0.5)")
    add(
        "--wait-for",
        metavar="TOPIC",
        action="append",
        default=[],
        help="begin when this published topic has a subscriber; repeatable",
    )
    add_domain(how, "0")
    add(
        "--range",
        choices=("LOCALHOST", "SUBNET"),
        help="who may listen (default: ROS_AUTOMATIC_DISCOVERY_RANGE, or LOCALHOST)",
    )
    add("--json", metavar="FILE", type=Path, help="write the summary for machines")


def execute(options: argparse.Namespace) -> int:
    """Play, and tell what was played; after an interruption too."""
    from steering_bringup.playback.playing import Played, play_bag

    wish, played = _wish(options), Played(options.bag)
    # An end by SIGTERM goes the ordinary way out: the terminal is put back, the nodes leave.
    signal.signal(signal.SIGTERM, _end)
    try:
        play_bag(wish, played, _open_publishers)
    finally:
        if played.passes or played.messages:
            print("\n".join(_lines(played)), flush=True)
            _write(options.json, played)
    return 0


def _wish(options: argparse.Namespace) -> Wish:
    from steering_bringup.playback.player import parse_rate
    from steering_bringup.playback.playing import Wish

    try:
        rate = parse_rate(options.rate)
    except ValueError as error:
        raise BenchError(str(error)) from None
    for name in ("clock", "delay"):
        if not 0.0 <= getattr(options, name) < 1e6:
            raise BenchError(f"--{name} must not be negative, got {getattr(options, name):g}")
    return Wish(
        options.bag,
        rate=rate,
        loop=options.loop,
        start=options.start,
        stop=options.stop,
        topics=tuple(options.topics),
        exclude=tuple(options.exclude),
        remaps=tuple(options.remap),
        clock=options.clock,
        delay=options.delay,
        wait_for=tuple(options.wait_for),
        domain=settle_domain(options),
        discovery=options.range,
    )


def _open_publishers(*arguments: Any, **options: Any) -> Any:
    from steering_bringup.playback.publishers import Publishers

    return Publishers(*arguments, **options)


def _end(number: int, frame: Any) -> None:
    sys.exit(128 + number)


def _lines(played: Played) -> list[str]:
    topics = sum(count > 0 for count in played.counts.values())
    passes = f", {played.passes} passes" if played.passes > 1 else ""
    what = f"{played.messages} messages on {topics} topics"
    shown = [f"{played.bag}: {what} in {played.wall_time:.2f} s{passes}"]
    if played.lateness:
        times = ", ".join(f"{name} {1e3 * late:.2f} ms" for name, late in played.lateness.items())
        shown.append(f"  late         {times}")
    shown += [f"  left out     {topic}: {why}" for topic, why in played.skipped.items()]
    shown += [f"  note         {note}" for note in played.notes]
    return [_printable(line) for line in shown]


def _printable(text: str) -> str:
    """Return one line: names in foreign bags may hold anything."""
    return "".join(c if c.isprintable() else ascii(c)[1:-1] for c in text)


def _write(file: Path | None, played: Played) -> None:
    if file is not None:
        write_json(file, played.as_json())
