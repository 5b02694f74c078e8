"""One call of the player on bags as people have them; what publishes is a list."""

from contextlib import contextmanager, suppress
from time import monotonic

import pytest
import yaml
from foreign_bags import FLOAT, STEP, T0, number, numbers, profile, write_mcap

from steering_bringup.errors import BenchError
from steering_bringup.playback import playing
from steering_bringup.playback.course import SECOND, Course
from steering_bringup.playback.playing import Played, Wish, play_bag

DAY = 86_400 * SECOND


class Heard:
    """Takes what is published; ends the playing after ``most`` messages."""

    has_clock = False

    def __init__(self, infos, names, most):
        self.topics = tuple(infos)
        self.counts = dict.fromkeys(infos, 0)
        self.skipped = {}
        self.rows = []
        self.most = most
        self.began = monotonic()

    def publish(self, topic, data):
        self.counts[topic] += 1
        self.rows.append((monotonic() - self.began, topic, data))
        if len(self.rows) == self.most:
            raise KeyboardInterrupt

    def hold_back(self, topic):
        pass

    def wait_for(self, names, patience):
        pass


def play(bag, most=10_000, **wish):
    """Return what was heard and the account of it."""
    heard = []

    @contextmanager
    def publishers(infos, names, *, clock, domain):
        heard.append(Heard(infos, names, most))
        yield heard[0]

    played = Played(bag)
    wanted = Wish(bag, **{"delay": 0.0, "clock": 0.0, **wish})
    with suppress(KeyboardInterrupt):
        play_bag(wanted, played, publishers)
    return heard[0], played


@pytest.fixture(autouse=True)
def no_middleware(monkeypatch):
    monkeypatch.setattr(playing, "_prepare_middleware", lambda wish: None)


def test_a_loop_over_one_message_is_paced(tmp_path):
    """As often as ros2 topic pub repeats one: once a second, here 20 times faster."""
    bag = write_mcap(tmp_path / "x.mcap", [("/a", FLOAT, numbers(1))])
    heard, played = play(bag, most=5, loop=True, rate=20.0)
    assert heard.rows[-1][0] > 4 / 20 - 0.01
    assert played.passes == 4


def test_a_loop_over_messages_of_one_time_is_paced(tmp_path):
    channels = [(topic, FLOAT, numbers(3, step=0)) for topic in ("/a", "/b")]
    heard, _ = play(write_mcap(tmp_path / "x.mcap", channels), most=13, loop=True, rate=20.0)
    assert heard.rows[-1][0] > 2 / 20 - 0.01


def test_the_step_between_passes_is_the_bag_s_own(tmp_path):
    bag = write_mcap(tmp_path / "x.mcap", [("/a", FLOAT, numbers(5))])
    heard, _ = play(bag, most=21, loop=True)
    assert heard.rows[-1][0] == pytest.approx(20 * STEP / SECOND, abs=0.05)


@pytest.mark.parametrize("odd", [0, -5, T0 - 2 * DAY, T0 + 2 * DAY, (1 << 63) - 1])
def test_nobody_waits_for_a_message_of_another_time(odd, tmp_path):
    rows = sorted([*numbers(), (odd, number(-1.0))])
    bag = write_mcap(tmp_path / "x.mcap", [("/a", FLOAT, [(s % (1 << 64), d) for s, d in rows])])
    began = monotonic()
    heard, played = play(bag)
    assert 0.18 < monotonic() - began < 2.0
    assert [data for _, _, data in heard.rows] == [data for _, data in rows]
    assert any("nothing was recorded for" in note for note in played.notes)


def test_from_and_to_count_what_is_played(tmp_path):
    rows = [(0, number(-1.0)), *numbers(), *numbers(20, T0 + 3 * DAY)]
    bag = write_mcap(tmp_path / "x.mcap", [("/a", FLOAT, rows)])
    heard, _ = play(bag, start=0.15, stop=0.25, rate=100.0)
    assert [data for _, _, data in heard.rows] == [
        number(k) for k in (15, 16, 17, 18, 19, 0, 1, 2, 3, 4, 5)
    ]


def latched(*depths):
    return ("cdr", {"offered_qos_profiles": yaml.safe_dump([profile(depth=d) for d in depths])})


@pytest.mark.parametrize(
    ("depths", "kept"), [((1,), (2,)), ((2,), (1, 2)), ((1, 1), (0, 1, 2)), ((), ())]
)
def test_what_was_kept_comes_before_from(depths, kept, tmp_path):
    """Of one publisher what it kept; of several all, for nobody knows whose is whose."""
    rows = [(T0 + k * STEP, number(100.0 + k)) for k in (0, 1, 2, 7)]
    channels = [("/map", FLOAT, rows, latched(*depths)), ("/a", FLOAT, numbers())]
    bag = write_mcap(tmp_path / "x.mcap", channels)
    heard, played = play(bag, start=0.05, rate=100.0)
    maps = [data for _, topic, data in heard.rows if topic == "/map"]
    assert maps == [number(100.0 + k) for k in (*kept, 7)]
    assert heard.rows[0][2] == (number(100.0 + kept[0]) if kept else number(5.0))
    assert any("kept messages" in note for note in played.notes) == bool(kept)


def test_where_nothing_can_be_published_it_is_an_error(tmp_path):
    bag = write_mcap(tmp_path / "x.mcap", [("/a", FLOAT, [(T0, b"\x04\x22\x4d\x18")])])
    with pytest.raises(BenchError, match="1 messages are left out: they are no CDR"):
        play(bag)


@pytest.mark.parametrize(
    ("wish", "text"),
    [
        ({"start": 5.0}, "0.190 s long"),
        ({"start": -1.0}, "0.190 s long"),
        ({"start": float("nan")}, "0.190 s long"),
        ({"start": 0.1, "stop": 0.1}, "not after"),
        ({"stop": float("nan")}, "not after"),
    ],
)
def test_times_that_are_none(wish, text, tmp_path):
    bag = write_mcap(tmp_path / "x.mcap", [("/a", FLOAT, numbers())])
    with pytest.raises(BenchError, match=text):
        play(bag, **wish)


def test_to_may_be_beyond_the_end(tmp_path):
    bag = write_mcap(tmp_path / "x.mcap", [("/a", FLOAT, numbers())])
    assert len(play(bag, stop=float("inf"), rate=100.0)[0].rows) == 20


def test_a_course_has_no_silences():
    course = Course.of([(0, 0), (T0, T0 + 100), (T0 + 2 * DAY, T0 + 2 * DAY + 50)])
    assert (course.length, course.lengths) == (150, [0, 100, 50])
    assert [course.played(t) for t in (0, T0, T0 + 100, T0 + 2 * DAY + 7)] == [0, 0, 100, 107]
    part = course.part(40, 120)
    assert part.spans == ((T0 + 40, T0 + 101), (T0 + 2 * DAY, T0 + 2 * DAY + 20))
    assert (part.length, part.lengths) == (80, [60, 20])
    assert part.played(T0 + 2 * DAY + 1) == 61
    assert course.silences()[0].startswith("nothing was recorded for 53.9 years after 1970-01-01")
