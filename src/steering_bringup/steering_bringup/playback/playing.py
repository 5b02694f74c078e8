"""One call of ``steer play``: open, choose, publish, tell."""

from __future__ import annotations

import os
from collections.abc import Callable
from contextlib import closing
from dataclasses import dataclass, field
from pathlib import Path
from time import monotonic_ns
from typing import Any

from steering_bringup.errors import BenchError
from steering_bringup.playback.choice import chosen_topics, parse_remaps
from steering_bringup.playback.keys import Keys
from steering_bringup.playback.player import Player
from steering_bringup.playback.source import Source, open_source
from steering_bringup.progress import Bar

SECOND = 1_000_000_000


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
    with closing(open_source(wish.bag)) as source:
        _play(source, wish, played, open_publishers)


def _play(source: Source, wish: Wish, played: Played, open_publishers: Callable[..., Any]) -> None:
    played.notes += source.notes
    names = parse_remaps(wish.remaps, chosen_topics(source.topics, wish.topics, wish.exclude))
    start, stop = _extent(wish, source)
    _prepare_middleware(wish)
    infos = {topic: source.topics[topic] for topic in names}
    with open_publishers(infos, names, clock=wish.clock > 0.0, domain=wish.domain) as sink:
        played.counts, played.skipped = sink.counts, sink.skipped
        if not sink.topics:
            reasons = "; ".join(f"{topic}: {why}" for topic, why in sink.skipped.items())
            raise BenchError(f"'{wish.bag}': no topic is left to play ({reasons})")
        # The delay serves those that nobody waits for.
        sink.wait_for(wish.wait_for, wish.patience)
        with Keys() as keys, Bar(wish.bag.name, (stop - start) * 1e-9) as bar:
            began = monotonic_ns()

            def show(recorded: int, paused: bool) -> None:
                played.wall_time = (monotonic_ns() - began) * 1e-9
                bar.update((recorded - start) // 1_000_000, _factor(player), _phase(paused))

            step = max(1, round(SECOND / wish.clock)) if wish.clock > 0.0 else SECOND
            player = Player(sink, keys, wish.rate, clock_step=step, show=show)
            player.settle(wish.delay)
            began = monotonic_ns()
            try:
                _passes(player, source, sink.topics, start, stop, wish.loop)
            finally:
                played.wall_time = (monotonic_ns() - began) * 1e-9
                played.passes = player.passes
                played.lateness = player.lateness.as_json() if player.lateness.count else {}


def _passes(
    player: Player, source: Source, topics: tuple[str, ...], start: int, stop: int, loop: bool
) -> None:
    """Play once or for ever; each pass begins where the last one's time is over."""
    due = monotonic_ns()
    length = min(stop, source.end + _usual_step(source)) - start
    while not player.ended:
        player.play(source.messages(topics, start, stop), start, due)
        if not loop:
            return
        due = player.timeline.due(start + length)


def _usual_step(source: Source) -> int:
    """Return ns from one message to the next on the bag's fastest topic."""
    most = max(info.count for info in source.topics.values())
    return max(1, round((source.end - source.start) / max(1, most - 1)))


def _extent(wish: Wish, source: Source) -> tuple[int, int]:
    """Return the first ns that is played, and the first that is not."""
    length = (source.end - source.start) / SECOND
    start = source.start + round(wish.start * SECOND)
    stop = source.end + 1
    if wish.stop is not None:
        stop = min(stop, source.start + round(wish.stop * SECOND))
    if not 0.0 <= wish.start <= length:
        raise BenchError(f"--from {wish.start:g}: the bag '{wish.bag}' is {length:.3f} s long")
    if stop <= start:
        raise BenchError(f"--to {wish.stop:g} is not after --from {wish.start:g}")
    return start, stop


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
