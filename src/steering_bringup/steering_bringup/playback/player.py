"""Publishes a bag's messages when they are due. No ROS: it is given what publishes."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator
from itertools import groupby
from math import inf, isinf
from time import monotonic_ns
from typing import Protocol

from steering_bringup.bags.sources import Message
from steering_bringup.playback.keys import FASTER, PAUSE, QUIT, SLOWER, STEP
from steering_bringup.playback.lateness import Lateness
from steering_bringup.playback.timeline import Timeline

LOOK_EVERY_NS = 50_000_000
"""Between two looks at the keyboard and two pictures of the bar."""

BEHIND_NS = 20_000_000
"""Later than this the wanted rate cannot be held: subscribers are then waited for."""

DEPTH = 1000
"""Messages that a publisher keeps for slow and late subscribers where the bag does not tell."""

SLOWEST, FASTEST = 2.0**-7, 2.0**7


class Sink(Protocol):
    """What takes the messages."""

    @property
    def has_clock(self) -> bool:
        """Whether ``tell_time`` is wanted."""

    def publish(self, topic: str, data: bytes) -> None:
        """Publish recorded bytes."""

    def tell_time(self, nanoseconds: int) -> None:
        """Publish the time of the recording."""

    def hold_back(self, topic: str) -> None:
        """Wait for slow subscribers."""


class Keyboard(Protocol):
    """What waits and listens."""

    def wait(self, seconds: float) -> list[str]:
        """Wait at most so long; return the meanings of keys that came."""


class Player:
    """Plays stretches of messages. ``show(recorded ns, paused)`` is called about 20 times a second.

    clock_step: ns of recording between two messages on /clock.
    """

    def __init__(
        self,
        sink: Sink,
        keyboard: Keyboard,
        rate: float,
        *,
        clock_step: int,
        show: Callable[[int, bool], None] = lambda recorded, paused: None,
        now: Callable[[], int] = monotonic_ns,
    ) -> None:
        self.sink = sink
        self.timeline = Timeline(rate)
        self.lateness = Lateness()
        self.ended = False
        self._keyboard = keyboard
        self._clock_step = clock_step
        self._show = show
        self._now = now
        self._next_look = 0
        self._steps = 0

    def settle(self, seconds: float) -> None:
        """Wait before the first stretch; a key counts already."""
        until = self._now() + round(seconds * 1e9)
        while not self.ended and (remaining := until - self._now()) > 0:
            self._heed(self._keyboard.wait(remaining * 1e-9))

    def play(self, messages: Iterable[Message], start: int, due: int | None = None) -> None:
        """Play one stretch whose time begins at ``start`` ns.

        ``due``: wall-clock time (monotonic, ns) of the beginning, now by default, so that stretches
        can follow each other without a seam.
        """
        timeline = self.timeline
        timeline.start(self._now() if due is None else due, start)
        for at, group, tells in self._events(messages, start):
            if not self._wait(at, bool(group)):
                return
            if tells:
                self.sink.tell_time(at)
            if group:
                self._publish(group, at)

    def publish_kept(self, messages: Iterable[Message]) -> None:
        """Publish at once what was kept from before the beginning."""
        for _, topic, data in messages:
            self.sink.publish(topic, data)
            self.sink.hold_back(topic)

    def _publish(self, group: list[Message], at: int) -> None:
        publish, flat_out = self.sink.publish, isinf(self.timeline.rate)
        late = 0 if flat_out else self._now() - self.timeline.due(at)
        for _, topic, data in group:
            publish(topic, data)
            if flat_out or late > BEHIND_NS:
                self.sink.hold_back(topic)
        if not flat_out:
            self.lateness.add(late)

    def _events(
        self, messages: Iterable[Message], start: int
    ) -> Iterator[tuple[int, list[Message], bool]]:
        """Yield (time, messages of that time, whether /clock is told), /clock in between too."""
        step, told = self._clock_step, self.sink.has_clock
        between = told and not isinf(self.timeline.rate)
        tick = start
        for at, group in groupby(messages, key=lambda message: message[0]):
            while between and tick < at:
                yield tick, [], True
                tick += step
            tells = told and tick <= at
            if tells:
                tick += ((at - tick) // step + 1) * step
            yield at, list(group), tells

    def _wait(self, at: int, has_messages: bool) -> bool:
        """Wait until ``at`` is due; False if the user ends the playing.

        A step goes to the next messages; what /clock tells before them comes along.
        """
        timeline = self.timeline
        while not self.ended:
            now = self._now()
            if now >= self._next_look:
                self._next_look = now + LOOK_EVERY_NS
                self._show(at, timeline.paused)
                self._heed(self._keyboard.wait(0.0))
            if timeline.paused:
                if self._steps:
                    self._steps -= has_messages
                    timeline.start(now, at)
                    return True
                self._heed(self._keyboard.wait(LOOK_EVERY_NS * 1e-9))
                continue
            remaining = timeline.due(at) - self._now()
            if remaining <= 0:
                return not self.ended
            self._heed(self._keyboard.wait(min(remaining, LOOK_EVERY_NS) * 1e-9))
        return False

    def _heed(self, keys: list[str]) -> None:
        timeline, now = self.timeline, self._now()
        for key in keys:
            if key == PAUSE:
                timeline.pause(now)
                self._steps = 0
            elif key == STEP:
                if not timeline.paused:
                    timeline.pause(now)
                else:
                    self._steps += 1
            elif key in (FASTER, SLOWER):
                factor = 2.0 if key == FASTER else 0.5
                timeline.set_rate(now, min(max(timeline.rate * factor, SLOWEST), FASTEST))
            elif key == QUIT:
                self.ended = True
            self._next_look = 0


def parse_rate(text: str) -> float:
    """Return a rate from "2", "0.1x" or "max"; ValueError says what is expected."""
    if text == "max":
        return inf
    try:
        rate = float(text.removesuffix("x"))
    except ValueError:
        rate = 0.0
    if not 0.0 < rate < inf:
        raise ValueError(f"--rate {text}: a number greater than 0, or max for as fast as it goes")
    return rate
