"""A node replaced by what it published in a bag: the messages that a run needs, checked."""

from __future__ import annotations

import hashlib
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from steering_bringup.errors import BenchError
from steering_lockstep.graph import NodeSpec
from steering_lockstep.settings import RunSettings
from steering_lockstep.topics import CLOCK, TABLE, wire
from steering_lockstep.wire import NANOSECONDS_PER_TICK, TICKS_PER_SECOND, Wire

if TYPE_CHECKING:
    from steering_bringup.bags import Trace

REPLAY_KIND = "replay"


@dataclass(frozen=True)
class Replay:
    """``node`` publishes what ``bag`` holds.

    payloads: topic -> (n, size) uint8, the bytes of the run's messages in order. notes: what the
    bag's reader had to say (damage, gaps).
    """

    node: str
    bag: Path
    payloads: Mapping[str, np.ndarray]
    started: str = ""
    notes: tuple[str, ...] = ()

    def columns(self) -> dict[str, np.ndarray]:
        """Return the numbers of each topic's messages, (n, fields); /clock has none."""
        return {topic: numbers(topic, rows) for topic, rows in self.payloads.items()}

    def origin(self) -> dict[str, Any]:
        """Return for a bag's metadata what was replayed; the digest is that of the payloads."""
        digest = hashlib.sha256()
        for topic in sorted(self.payloads):
            digest.update(self.payloads[topic].tobytes())
        return {
            "bag": str(self.bag),
            "started": self.started,
            "topics": sorted(self.payloads),
            "sha256": digest.hexdigest(),
        }


def parse_replay(text: str) -> tuple[str, Path]:
    """Return node and bag of "NODE=BAG"."""
    node, sign, bag = (part.strip() for part in text.partition("="))
    if not sign or not node or not bag:
        raise BenchError(f"--from-bag {text}: write NODE=BAG, such as driver=results/step-1/mine")
    return node, Path(bag)


def load_replay(spec: NodeSpec, run: RunSettings, bag: Path) -> Replay:
    """Return what node ``spec`` published in ``bag`` at the ticks of ``run``.

    Raises BenchError, naming bag, topic and tick, where the bag does not hold every message.
    """
    from steering_bringup.bags import read_bag

    trace = read_bag(bag)
    payloads = {
        topic: _messages(trace, spec.name, topic, run.ticks, run.every(topic))
        for topic in spec.outputs
        if TABLE[topic].lockstep
    }
    started = str(trace.run.get("started", ""))
    return Replay(spec.name, bag.resolve(), payloads, started, tuple(trace.notes))


def numbers(topic: str, payloads: np.ndarray) -> np.ndarray:
    """Return the numbers of messages (n, size) as (n, fields), without stamp and tick."""
    rows, fields = _rows(payloads, wire(topic)), wire(topic).fields
    return np.column_stack([rows[name] for name in fields]) if fields else np.empty((len(rows), 0))


def _messages(trace: Trace, node: str, topic: str, ticks: int, every: int) -> np.ndarray:
    """Return the payloads of ticks 0, ``every``, ... before ``ticks``."""
    where = f"node '{node}' cannot be replayed from bag '{trace.path}': {topic}"
    payloads = _payloads(trace, topic, where)
    have = _ticks(payloads, wire(topic), where)
    needed = np.arange(0, ticks, every)
    if have[-1] < needed[-1]:
        raise BenchError(
            f"{where} ends at tick {have[-1]}, but the run needs tick {needed[-1]}: shorten the "
            f"run (--duration {(have[-1] + 1) * 1e-3:g}) or name a longer bag"
        )
    place = np.minimum(np.searchsorted(have, needed), len(have) - 1)
    missing = needed[have[place] != needed]
    if len(missing):
        raise BenchError(
            f"{where} has no message of tick {missing[0]} ({len(missing)} of {len(needed)} are "
            "missing): name a bag that lost nothing"
        )
    chosen = np.ascontiguousarray(payloads[place])
    values = numbers(topic, chosen)
    bad = np.argwhere(~np.isfinite(values))
    if len(bad):
        row, column = bad[0]
        field, tick = wire(topic).fields[column], needed[row]
        raise BenchError(f"{where}, field {field} is not finite at tick {tick}")
    return chosen


def _payloads(trace: Trace, topic: str, where: str) -> np.ndarray:
    """Return all messages of a topic, of the bench's own type and layout."""
    kind = TABLE[topic].type_name.replace("/", "/msg/")
    if topic not in trace.types:
        hint = " or leave the true states out (--no-truth)" if topic.startswith("/truth/") else ""
        raise BenchError(f"{where} is not in it: name a bag that recorded it{hint}")
    if trace.types[topic] != kind:
        raise BenchError(f"{where} is {trace.types[topic]} there, not {kind}")
    payloads = trace.payloads.get(topic)
    layout = wire(topic)
    if payloads is None or not len(payloads):
        raise BenchError(f"{where} has no messages of one size there: name another bag")
    if payloads.shape[1] != layout.size or not _constants_agree(payloads, layout):
        names = ", ".join(f"{path} '{text}'" for path, text in TABLE[topic].strings.items())
        raise BenchError(
            f"{where} has messages of another layout than the bench's {layout.size} bytes"
            + (f" with {names}" if names else "")
        )
    return payloads


def _constants_agree(payloads: np.ndarray, layout: Wire) -> bool:
    """Whether encapsulation and strings are those that the bench writes."""
    template = np.frombuffer(layout.template, np.uint8)
    fixed = [(0, 4)] + [(s.offset, s.size) for s in layout.slots if s.constant is not None]
    return all(
        bool(np.all(payloads[:, start : start + size] == template[start : start + size]))
        for start, size in fixed
    )


def _ticks(payloads: np.ndarray, layout: Wire, where: str) -> np.ndarray:
    """Return the messages' ticks, (n,) int64, which must rise and agree with the stamps."""
    rows = _rows(payloads, layout)
    nanoseconds = rows["nanosec"].astype(np.int64)
    ticks = rows["sec"].astype(np.int64) * TICKS_PER_SECOND + nanoseconds // NANOSECONDS_PER_TICK
    wrong = nanoseconds % NANOSECONDS_PER_TICK != 0
    if layout.has_tick:
        wrong |= rows["tick"].astype(np.int64) != ticks
    if wrong.any():
        first = int(np.argmax(wrong))
        raise BenchError(f"{where}, message {first}: its stamp is not its tick x 1 ms")
    falling = ticks[1:] <= ticks[:-1]
    if falling.any():
        tick = ticks[np.argmax(falling) + 1]
        raise BenchError(f"{where} comes to tick {tick} a second time: name a bag of one run")
    return ticks


def _rows(payloads: np.ndarray, layout: Wire) -> np.ndarray:
    return np.ascontiguousarray(payloads).view(layout.dtype).reshape(-1)


def is_clock(spec: NodeSpec) -> bool:
    """Whether the node gives the ticks: the plant, or what takes its place."""
    return CLOCK in spec.outputs
