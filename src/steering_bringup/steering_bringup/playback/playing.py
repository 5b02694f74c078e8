"""One call of ``steer play``: open, choose, publish, tell."""

from __future__ import annotations

import os
from collections import deque
from collections.abc import Callable, Iterator
from contextlib import closing
from dataclasses import dataclass, field
from math import inf
from pathlib import Path
from time import monotonic_ns
from typing import Any

from steering_bringup.bags.sources import EARLIEST, Bag, Message, open_bag
from steering_bringup.errors import BenchError
from steering_bringup.playback.choice import chosen_topics, parse_remaps
from steering_bringup.playback.course import Course
from steering_bringup.playback.keys import Keys
from steering_bringup.playback.player import DEPTH, Player
from steering_bringup.progress import Bar

SECOND = 1_000_000_000

LEAST_STEP, USUAL_STEP = SECOND // 1000, SECOND
"""ns from the last message of a pass to the first of the next: at least, and where the bag has no
two messages of one topic at different times, which is how often ``ros2 topic pub`` repeats one."""


@dataclass(frozen=True)
class Wish:
    """What is to be played and how.

    ``rate``: recorded over wall-clock time, infinite: as fast as it goes. ``start``, ``stop``: s
    from the bag's first message. ``clock``: Hz at rate 1, 0: none. ``delay``: s for subscribers to
    be found; ``wait_for``: topics that must have a subscriber first, ``patience``: s for that.
    """

    bag: Path
    rate: float = 1.0
    loop: bool = False
    start: float = 0.0
    stop: float | None = None
    topics: tuple[str, ...] = ()
    exclude: tuple[str, ...] = ()
    remaps: tuple[str, ...] = ()
    clock: float = 100.0
    delay: float = 0.5
    wait_for: tuple[str, ...] = ()
    patience: float = 30.0
    domain: int | None = None
    discovery: str | None = None


@dataclass
class Played:
    """What was played. ``counts``: published messages by the bag's topics."""

    bag: Path
    counts: dict[str, int] = field(default_factory=dict)
    skipped: dict[str, str] = field(default_factory=dict)
    notes: list[str] = field(default_factory=list)
    recorded: float = 0.0
    wall_time: float = 0.0
    passes: int = 0
    lateness: dict[str, float] = field(default_factory=dict)

    @property
    def messages(self) -> int:
        """Messages on all topics."""
        return sum(self.counts.values())

    def as_json(self) -> dict[str, Any]:
        """Return it for machines; times in s."""
        return {
            "bag": str(self.bag),
            "messages": self.messages,
            "counts": self.counts,
            "skipped": self.skipped,
            "notes": self.notes,
            "wall_time": self.wall_time,
            "passes": self.passes,
            "lateness": self.lateness,
        }


def play_bag(wish: Wish, played: Played, open_publishers: Callable[..., Any]) -> None:
    """Play and keep account in ``played``, which is right after an interruption too.

    ``open_publishers`` makes ``Publishers``; ROS starts no earlier, so that it finds its settings.
    Raises BenchError before anything is published where the wish cannot be met.
    """
    with closing(open_bag(wish.bag)) as bag:
        try:
            _play(bag, wish, played, open_publishers)
            if bag.bad_messages and not played.messages:
                raise BenchError(f"'{wish.bag}': nothing can be played: {'; '.join(bag.notes)}")
        finally:
            played.notes += bag.notes


def _play(bag: Bag, wish: Wish, played: Played, open_publishers: Callable[..., Any]) -> None:
    known = dict.fromkeys(info.name for info in bag.topics.values())
    renamed = parse_remaps(wish.remaps, chosen_topics(known, wish.topics, wish.exclude))
    infos = {label: info for label, info in bag.topics.items() if info.name in renamed}
    names = {label: renamed[info.name] for label, info in infos.items()}
    whole = Course.of(bag.spans)
    course = _part(wish, whole)
    _prepare_middleware(wish)
    with open_publishers(infos, names, clock=wish.clock > 0.0, domain=wish.domain) as sink:
        played.counts, played.skipped = sink.counts, sink.skipped
        if not sink.topics:
            reasons = "; ".join(f"{topic}: {why}" for topic, why in sink.skipped.items())
            raise BenchError(f"'{wish.bag}': no topic is left to play ({reasons})")
        kept = _kept(bag, sink.topics, course) if course.spans[0][0] > bag.start else []
        played.notes += course.silences()
        if kept:
            played.notes.append(f"{len(kept)} kept messages from before --from come first")
        # The delay serves those that nobody waits for.
        sink.wait_for(wish.wait_for, wish.patience)
        with Keys() as keys, Bar(wish.bag.name, course.length * 1e-9) as bar:
            began = monotonic_ns()

            def show(recorded: int, paused: bool) -> None:
                played.wall_time = (monotonic_ns() - began) * 1e-9
                bar.update(course.played(recorded) // 1_000_000, _factor(player), _phase(paused))

            step = max(1, round(SECOND / wish.clock)) if wish.clock > 0.0 else SECOND
            player = Player(sink, keys, wish.rate, clock_step=step, show=show)
            player.settle(wish.delay)
            began = monotonic_ns()
            pause = _step(bag) if course.spans[-1][1] > bag.end else 0
            try:
                for _ in _passes(player, bag, sink.topics, course, kept, pause):
                    played.passes += 1
                    if not wish.loop:
                        break
            finally:
                played.wall_time = (monotonic_ns() - began) * 1e-9
                played.lateness = player.lateness.as_json() if player.lateness.count else {}


def _passes(
    player: Player,
    bag: Bag,
    topics: tuple[str, ...],
    course: Course,
    kept: list[Message],
    pause: int,
) -> Iterator[None]:
    """Play again and again; each pass begins where the last one's time is over."""
    due = monotonic_ns()
    while True:
        player.publish_kept(kept)
        for (first, stop), length in zip(course.spans, course.lengths, strict=True):
            player.play(bag.messages(topics, first, stop), first, due)
            if player.ended:
                return
            due = player.timeline.due(first + length)
        yield
        due = player.timeline.due(first + length + pause)


def _kept(bag: Bag, topics: tuple[str, ...], course: Course) -> list[Message]:
    """Return what publishers had kept for late subscribers when the course begins."""
    durable = [topic for topic in topics if bag.topics[topic].durable]
    last = {topic: deque[Message](maxlen=bag.topics[topic].depth or DEPTH) for topic in durable}
    if durable:
        for message in bag.messages(durable, EARLIEST, course.spans[0][0]):
            last[message[1]].append(message)
    return sorted((m for messages in last.values() for m in messages), key=lambda m: m[0])


def _step(bag: Bag) -> int:
    """Return ns from one message to the next on the bag's fastest topic."""
    most, length = max(info.count for info in bag.topics.values()), Course.of(bag.spans).length
    return max(LEAST_STEP, length // (most - 1)) if most > 1 and length else USUAL_STEP


def _part(wish: Wish, whole: Course) -> Course:
    """Return what is played of a bag's course."""
    length = whole.length / SECOND
    if not 0.0 <= wish.start <= length:
        raise BenchError(f"--from {wish.start:g}: the bag '{wish.bag}' is {length:.3f} s long")
    stop = inf if wish.stop is None else wish.stop
    if not stop > wish.start:
        raise BenchError(f"--to {stop:g} is not after --from {wish.start:g}")
    until = whole.length + 1 if stop > length else round(stop * SECOND)
    return whole.part(round(wish.start * SECOND), until)


def _prepare_middleware(wish: Wish) -> None:
    """Set what rclpy reads as it starts."""
    from steering_lockstep.middleware import RANGE, ros_environment

    if wish.discovery is not None:
        os.environ[RANGE] = wish.discovery
    os.environ.update(ros_environment(os.environ))


def _factor(player: Player) -> float:
    return 0.0 if player.timeline.paused else player.timeline.rate


def _phase(paused: bool) -> str:
    return "paused" if paused else "running"
