"""Sources, freshness, fading, refusal and the driver's hands."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from overlay_rules import (
    APPLIED,
    ASKED,
    AUTHORITY,
    CHANGING,
    HAND,
    OVERRIDDEN,
    OVERRIDES,
    REFUSALS,
    REFUSED,
    SILENCES,
    SOURCE,
    STALE,
    Rules,
)

from pressure_control.overlay.arbiter import OverlayArbiter
from steering_core.parameters import load_parameters

PARAMETERS = load_parameters()
RULES = Rules()
STEP = RULES.step


class Bench:
    """An arbiter whose sources, driver and wheel are set by hand."""

    def __init__(self, *periods, parameters=PARAMETERS):
        self.arbiter = OverlayArbiter(parameters, periods)
        self.tick = 0
        self.sources = [[0.0, -1.0] for _ in periods]
        self.bar = self.wheel = 0.0

    def run(self, ticks, *sources):
        """Go on for ``ticks``; return the rows (ticks, 19)."""
        for i, source in enumerate(sources):
            self.sources[i] = list(source)
        rows = []
        for _ in range(ticks):
            asked = [v for source in self.sources for v in source]
            out = self.arbiter.step(self.tick, 0.0, self.wheel, self.bar, 20.0, *asked)
            rows.append(out.copy())
            self.tick += 1
        return np.array(rows)

    def guest(self, name, torque, priority=1.0):
        self.arbiter.hear_guest(name, self.tick, torque, priority)


def test_nobody_asks_and_nothing_is_applied():
    out = Bench().run(50)
    assert not out[:, [ASKED, APPLIED, SOURCE, STALE, REFUSED, OVERRIDDEN]].any()
    assert np.all(out[:, AUTHORITY] == 1.0)


def test_entry_and_leaving_are_ramps_without_a_bump():
    bench = Bench(1)
    rise, fall = bench.run(600, (4.0, 1.0)), bench.run(600, (4.0, -1.0))
    for rows, start, end in ((rise, 0.0, 4.0), (fall, 4.0, 0.0)):
        steps = np.diff(rows[:, APPLIED], prepend=start)
        assert rows[-1, APPLIED] == pytest.approx(end, abs=1e-12)
        # half a second from one to the other, at one rate
        np.testing.assert_allclose(steps[:499], (end - start) / 500.0, rtol=1e-6)
        assert np.all(rows[:498, CHANGING] == 1.0)
        assert not rows[-1, CHANGING]
    assert rise[-1, SOURCE] == 1
    assert fall[-1, SOURCE] == 0


def test_the_greatest_priority_is_served_and_handed_over_smoothly():
    bench = Bench(1, 1, 1)
    bench.run(600, (1.0, 1.0), (2.0, 3.0), (3.0, 2.0))
    out = bench.run(600, (-1.0, 4.0))
    assert out[0, SOURCE] == 1
    assert np.max(np.abs(np.diff(out[:, APPLIED], prepend=2.0))) == pytest.approx(3.0 / 500)
    assert out[-1, APPLIED] == -1.0


def test_equal_priorities_go_to_the_first():
    assert Bench(1, 1).run(5, (1.0, 2.0), (3.0, 2.0))[-1, SOURCE] == 1


@given(ranks=st.lists(st.floats(-5.0, 5.0), min_size=1, max_size=12))
@settings(max_examples=60, deadline=None)
def test_any_number_of_sources(ranks):
    bench = Bench(*[1] * len(ranks))
    out = bench.run(3, *[(float(i), rank) for i, rank in enumerate(ranks)])[-1]
    willing = [rank for rank in ranks if rank >= 0.0]
    expected = ranks.index(max(willing)) + 1 if willing else 0
    assert out[SOURCE] == expected
    assert out[ASKED] == (expected - 1 if expected else 0.0)


@pytest.mark.parametrize("wrong", [np.nan, np.inf, -np.inf, 30.1, -1e9])
def test_what_is_no_wish_is_refused_counted_and_ends_in_silence(wrong):
    bench = Bench(10)
    held = bench.run(700, (5.0, 1.0))[-1, APPLIED]
    bad = bench.run(800, (wrong, 1.0))
    assert bad[0, REFUSED] == 1.0
    assert bad[9, REFUSALS] == 1
    assert bad[-1, REFUSALS] == 80
    # the last good message is 10 ticks old at the first bad one, and counts for 30
    assert np.all(bad[:21, APPLIED] == held)
    assert np.flatnonzero(bad[:, STALE])[0] == 21
    assert bad[-1, SILENCES] == 1
    assert np.max(np.abs(np.diff(bad[:, APPLIED], prepend=held))) <= held / 500 + 1e-9
    assert bad[-1, APPLIED] == 0.0


def test_one_refused_message_among_good_ones_changes_nothing():
    bench = Bench(10)
    before = bench.run(700, (5.0, 1.0))[-1]
    during, after = bench.run(10, (np.nan, 1.0)), bench.run(20, (5.0, 1.0))
    assert np.all(during[:, APPLIED] == before[APPLIED])
    assert np.all(after[:, APPLIED] == before[APPLIED])
    assert not after[:, [REFUSED, STALE, CHANGING]].any()
    assert after[-1, REFUSALS] == 1


@pytest.mark.parametrize("priority", [np.nan, np.inf, 1e9])
def test_a_priority_that_is_none_is_refused(priority):
    out = Bench(1).run(5, (1.0, priority))
    assert out[-1, REFUSALS] == 5
    assert out[-1, SOURCE] == 0


def test_a_guest_that_falls_silent_is_faded_out_and_comes_back():
    bench = Bench()
    for _ in range(70):
        bench.guest("far_away", 3.0)
        heard = bench.run(10)
    assert heard[-1, APPLIED] == 3.0
    silent = bench.run(600)
    first = np.flatnonzero(silent[:, STALE])[0]
    assert first == 21  # 30 ticks after the last message, which was 10 ticks old
    assert np.all(silent[:first, APPLIED] == 3.0)
    assert np.all(np.diff(silent[first:, APPLIED]) <= 0.0)
    assert silent[first, APPLIED] > 2.9
    assert silent[-1, APPLIED] == 0.0
    bench.guest("far_away", 3.0)
    assert 0.0 < bench.run(1)[-1, APPLIED] <= STEP


def test_a_member_whose_delay_is_longer_than_freshness_is_never_served():
    arbiter = OverlayArbiter(PARAMETERS, (10,), (45,))
    for tick in range(200):
        out = arbiter.step(tick, 0.0, 0.0, 0.0, 20.0, 5.0, 1.0)
    assert out[APPLIED] == 0.0
    assert out[STALE] == 1.0


def test_guests_and_members_are_numbered_in_order():
    bench = Bench(1)
    bench.run(1, (1.0, 1.0))
    bench.guest("one", 2.0, 2.0)
    assert bench.run(1)[-1, SOURCE] == 2
    bench.guest("two", 2.0, 3.0)
    assert bench.run(1)[-1, SOURCE] == 3
    assert list(bench.arbiter.guests) == ["one", "two"]


@pytest.mark.parametrize("side", [1.0, -1.0])
def test_the_driver_reduces_and_wins_on_either_side(side):
    """Half way between start and full half is left; at full nothing; it comes back slowly."""
    bench = Bench(1)
    bench.run(600, (side * 4.0, 1.0))
    bench.bar = -side * 2.0
    half = bench.run(400)
    assert half[-1, APPLIED] == pytest.approx(side * 2.0, rel=1e-5)
    bench.bar = -side * 3.2
    won = bench.run(400)
    assert won[-1, APPLIED] == 0.0
    assert won[-1, OVERRIDDEN] == 1.0
    assert won[-1, OVERRIDES] == 1
    bench.bar = 0.0
    back = bench.run(1200)
    assert back[500, AUTHORITY] < 0.6
    assert back[-1, AUTHORITY] == 1.0
    assert back[-1, APPLIED] == pytest.approx(side * 4.0, rel=1e-5)
    assert np.max(np.abs(np.diff(back[:, APPLIED]))) <= 4.0 / 1000.0 + 1e-9


def test_the_driver_wins_within_half_a_second_against_the_full_torque():
    bench = Bench(1)
    bench.run(1500, (10.0, 1.0))
    bench.bar = -5.0
    out = bench.run(600)
    assert np.flatnonzero(out[:, APPLIED] == 0.0)[0] < 500


def test_a_driver_who_turns_the_same_way_keeps_the_overlay():
    bench = Bench(1)
    bench.bar = 4.0
    assert bench.run(800, (3.0, 1.0))[-1, APPLIED] == 3.0


def test_a_dragged_steering_wheel_is_no_driver():
    """The wheel follows the rack by the bar's torque alone: J w' + d w + bar = 0."""
    bench = Bench(1)
    m = PARAMETERS.group("mechanics")
    bench.run(600, (5.0, 1.0))
    t = np.arange(1000) * 1e-3
    speed = 3.0 * np.sin(2 * np.pi * 3.0 * t)
    growth = 3.0 * 2 * np.pi * 3.0 * np.cos(2 * np.pi * 3.0 * t)
    bars = -m["steering_wheel_inertia"] * growth - m["steering_wheel_damping"] * speed
    assert np.max(np.abs(bars)) > 3.0  # the bar alone would be taken for a driver who wins
    for bench.wheel, bench.bar in zip(speed, bars, strict=True):
        out = bench.run(1)[-1]
        assert out[AUTHORITY] == 1.0
        assert abs(out[HAND]) < 0.2


def test_what_is_not_measured_hurts_nobody():
    bench = Bench(1)
    bench.bar = bench.wheel = np.nan
    first = bench.run(50, (5.0, 1.0))
    bench.bar, bench.wheel = np.inf, -np.inf
    RULES.check(np.vstack([first, bench.run(50)]))
