"""When the player publishes what, on a clock that the tests move."""

from math import inf

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from steering_bringup.playback.keys import FASTER, PAUSE, QUIT, SLOWER, STEP
from steering_bringup.playback.lateness import Lateness
from steering_bringup.playback.player import Player, parse_rate
from steering_bringup.playback.timeline import Timeline

MS = 1_000_000
BEGIN = 5_000 * MS


class World:
    """A wall clock that only waiting moves, a sink that notes, and keys at given times."""

    def __init__(self, keys=(), clock=False, cost=0):
        self.time = 0
        self.keys = list(keys)
        self.has_clock = clock
        self.cost = cost
        self.heard: list = []
        self.told: list = []
        self.held = 0

    def now(self):
        return self.time

    def wait(self, seconds):
        until = self.time + round(seconds * 1e9)
        if self.keys and self.keys[0][0] <= max(until, self.time):
            self.time = max(self.time, self.keys[0][0])
            return [self.keys.pop(0)[1]]
        self.time = until
        return []

    def publish(self, topic, data):
        self.heard.append((self.time, topic, data))
        self.time += self.cost

    def tell_time(self, nanoseconds):
        self.told.append((self.time, nanoseconds))

    def hold_back(self, topic):
        self.held += 1


def messages(count=10, step=MS, topics=("/a",)):
    return [(BEGIN + k * step, topic, b"%d" % k) for k in range(count) for topic in topics]


def play(world, rate=1.0, stream=None, clock_step=10 * MS):
    player = Player(world, world, rate, clock_step=clock_step, now=world.now)
    player.play(messages() if stream is None else stream, BEGIN)
    return player


@pytest.mark.parametrize(("rate", "step"), [(1.0, 1.0), (0.1, 10.0), (4.0, 0.25)])
def test_messages_leave_when_they_are_due(rate, step):
    world = World()
    play(world, rate)
    assert [t for t, _, _ in world.heard] == [round(k * step * MS) for k in range(10)]
    assert [d for _, _, d in world.heard] == [b"%d" % k for k in range(10)]


@pytest.mark.parametrize("cost", [MS // 10, MS // 2])
def test_what_publishing_takes_does_not_add_up(cost):
    world = World(cost=cost)
    play(world, stream=messages(1000))
    assert [t for t, _, _ in world.heard] == [k * MS for k in range(1000)]


def test_after_a_hold_up_the_old_deadlines_hold_again():
    world = World()
    stream = messages(200)

    def slow():
        for k, message in enumerate(stream):
            if k == 50:
                world.time += 30 * MS
            yield message

    player = play(world, stream=slow())
    times = [t for t, _, _ in world.heard]
    assert times[:49] == [k * MS for k in range(49)]
    assert times[100:] == [k * MS for k in range(100, 200)]
    assert player.lateness.largest > 25 * MS
    assert world.held > 0


def test_flat_out_nothing_waits_but_for_slow_subscribers():
    world = World()
    play(world, inf, messages(100))
    assert world.time == 0
    assert world.held == 100


def test_messages_of_one_stamp_leave_together():
    world = World()
    play(world, stream=messages(3, topics=("/a", "/b")))
    assert [(t, topic) for t, topic, _ in world.heard] == [
        (k * MS, topic) for k in range(3) for topic in ("/a", "/b")
    ]


def test_the_clock_goes_on_where_no_message_is():
    world = World(clock=True)
    play(world, stream=[(BEGIN, "/a", b""), (BEGIN + 35 * MS, "/a", b"")])
    assert world.told == [(k * MS, BEGIN + k * MS) for k in (0, 10, 20, 30)]


def test_the_clock_is_told_with_messages_when_flat_out():
    world = World(clock=True)
    play(world, inf, messages(100))
    assert [stamp for _, stamp in world.told] == [BEGIN + k * MS for k in range(0, 100, 10)]


def test_a_pause_moves_all_that_follows():
    world = World(keys=[(int(3.5 * MS), PAUSE), (103 * MS, PAUSE)])
    play(world)
    times = [t / MS for t, _, _ in world.heard]
    assert times[:4] == [0, 1, 2, 3]
    assert times[4:] == pytest.approx([k + 99.5 for k in range(4, 10)])


def test_a_step_in_a_pause_publishes_one_stamp():
    keys = [(3 * MS // 2, STEP), (50 * MS, STEP), (60 * MS, STEP), (70 * MS, PAUSE)]
    world = World(keys=keys, clock=True)
    play(world, stream=messages(6, topics=("/a", "/b")), clock_step=MS // 4)
    times = [t / MS for t, topic, _ in world.heard if topic == "/a"]
    assert times == pytest.approx([0, 1, 50, 60, 71, 72])
    assert [t for t, topic, _ in world.heard if topic == "/b"] == [t * MS for t in times]


def test_the_rate_can_be_changed_on_the_way():
    world = World(keys=[(4 * MS, FASTER), (6 * MS, SLOWER)])
    play(world, stream=messages(12))
    times = [t / MS for t, _, _ in world.heard]
    assert times == pytest.approx([0, 1, 2, 3, 4, 4.5, 5, 5.5, 6, 7, 8, 9])


def test_quit_ends_it():
    world = World(keys=[(int(2.5 * MS), QUIT)])
    player = play(world)
    assert len(world.heard) == 3
    assert player.ended


def test_passes_follow_without_a_seam():
    world = World()
    player = Player(world, world, 2.0, clock_step=MS, now=world.now)
    due = 0
    for _ in range(3):
        player.play(messages(), BEGIN, due)
        due = player.timeline.due(BEGIN + 10 * MS)
    assert [t for t, _, _ in world.heard] == [k * MS // 2 for k in range(30)]


@given(
    st.floats(0.01, 100.0),
    st.lists(st.tuples(st.integers(0, 10**10), st.sampled_from([0.5, 2.0, None])), max_size=8),
)
def test_time_never_runs_back(rate, events):
    """Whatever pauses and rates, what is not due yet is not due before now."""
    timeline, wall, place = Timeline(rate), 0, 0
    timeline.start(0, 0)
    for length, factor in events:
        if not timeline.paused:
            place += round(length * timeline.rate)
        wall += length
        if factor is None:
            timeline.pause(wall)
        else:
            timeline.set_rate(wall, timeline.rate * factor)
        if not timeline.paused:
            slack = 10 + 1e-9 * wall + 10 / timeline.rate
            assert timeline.due(place) == pytest.approx(wall, abs=slack)


def test_delays_are_counted():
    late = Lateness()
    for value in np.linspace(0, 1_000_000, 101):
        late.add(int(value))
    late.add(-5)
    assert late.percentile(0.5) == pytest.approx(5e-4, abs=2e-5)
    assert late.as_json()["max"] == 1e-3


@pytest.mark.parametrize(("text", "rate"), [("0.1", 0.1), ("10x", 10.0), ("max", inf)])
def test_rates(text, rate):
    assert parse_rate(text) == rate


@pytest.mark.parametrize("text", ["0", "-1", "fast", "inf", "nan", "", "1y"])
def test_bad_rates(text):
    with pytest.raises(ValueError, match="--rate"):
        parse_rate(text)
