"""What a key costs the bench in each tick: take the measurements, pack the commands, both sealed.

    steer bench rig_trust
    steer python benchmarks/rig_trust.py --ticks 5000 --rounds 20

The same packets of the shipped rig with a key and without one, in turns, in memory: what the link
itself takes is in neither. Processor time of this thread, with the collector of garbage off as in
the bridge; the best round, as whatever is slower was disturbed; taking and packing each in a loop
of its own. The target is 2 % of a period.
"""

from __future__ import annotations

import argparse
import gc
import sys
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

from rig_bridge.rig_file import RigFile, load_rig
from rig_bridge.shipped import find_rig
from rig_bridge.transport.can_codec import CanCodec
from rig_bridge.transport.can_link import described
from rig_bridge.transport.packets import Demand, Frame, Order
from rig_bridge.transport.settings import CanSettings
from rig_bridge.transport.udp_codec import UdpCodec
from steering_bringup.benchmarking.program import Measured, main
from steering_bringup.benchmarking.timing import in_turns

KEY = bytes(range(32))
Codec = Any
Make = Callable[[bytes | None, bool], Codec]


def udp(rig: RigFile, path: Path) -> Make:
    """Return what makes the codec of either end."""
    return lambda key, rig_end: UdpCodec(rig, key, rig_end)


def can(rig: RigFile, path: Path) -> Make:
    """Return what makes the codec of either end."""
    buses = described([CanSettings.model_validate({"interface": "virtual"})], path)
    return lambda key, rig_end: CanCodec(rig, buses, key, rig_end)


def met(make: Make, key: bytes | None) -> tuple[Codec, Codec]:
    """Return the codecs of bench and rig, in a session where there is a key."""
    bench, far = make(key, False), make(key, True)
    if key is not None:
        bench.peer.hear(far.peer.hear(bench.peer.greeting()))
        far.peer.current, far.peer.pending = far.peer.pending, None
    return bench, far


def tick_s(make: Make, key: bytes | None, rig: RigFile, ticks: int) -> float:
    """Return how long the bench's part of a tick takes [s]."""
    bench, far = met(make, key)
    values = tuple(0.5 * rig.channels[name].range[1] for name in rig.measured)
    asked = tuple(0.5 * rig.channels[name].range[1] for name in rig.commanded)
    frames = [far.pack_frame(Frame(k, k * 1_000_000, values)) for k in range(ticks)]
    is_can = not isinstance(frames[0], bytes)
    gc.collect()
    gc.disable()
    begin = time.thread_time()
    for packed in frames:
        if is_can:
            for frame in packed:
                came = bench.take_frame(*frame)
        else:
            came = bench.unpack_frame(packed)
        assert came is not None
    for k in range(ticks):
        bench.pack_demand(Demand(k, k, Order.RUN, asked))
    taken = time.thread_time() - begin
    gc.enable()
    return taken / ticks


def measure(options: argparse.Namespace) -> Measured:
    """Measure each link with and without a key."""
    path = find_rig("emulated")
    rig = load_rig(path)
    values: dict[str, float | None] = {}
    details = {}
    for name, codec in {"udp": udp, "can": can}.items():
        make = codec(rig, path.with_suffix(".dbc"))
        calls = {
            "without": lambda make=make: tick_s(make, None, rig, options.ticks),
            "with": lambda make=make: tick_s(make, KEY, rig, options.ticks),
        }
        found = in_turns(calls, options.rounds)
        best = {what: 1e6 * min(times) for what, times in found.items()}
        values |= {f"{name}_{what}": time_us for what, time_us in best.items()}
        values[f"{name}_cost"] = best["with"] - best["without"]
        details[name] = found
    return Measured(values, details)


def arguments(parser: argparse.ArgumentParser) -> None:
    """Declare the size."""
    parser.add_argument("--ticks", type=int, default=300, help="of each round (default: 300)")
    parser.add_argument("--rounds", type=int, default=60, help="of each row (default: 60)")


if __name__ == "__main__":
    sys.exit(main("rig_trust", measure, arguments, __doc__))
