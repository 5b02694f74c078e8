"""Guests at any rate: their period is learnt, and one that stops is faded after three of it."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from overlay_rules import APPLIED, SILENCES, SOURCE, STALE, Rules

from pressure_control.overlay.arbiter import OverlayArbiter
from pressure_control.overlay.guests import Rhythm
from steering_core.parameters import ParameterError, load_parameters

PARAMETERS = load_parameters()
SHORTEST, LONGEST = 10, 1000
"""ticks, as on the data sheet"""


def run(ticks, messages, arbiter=None):
    """Return what the arbiter gives, (ticks, 19); messages: {tick: [(name, torque, rank)]}."""
    arbiter, rows = arbiter or OverlayArbiter(PARAMETERS), []
    for tick in range(ticks):
        for name, torque, rank in messages.get(tick, ()):
            arbiter.hear_guest(name, tick, torque, rank)
        rows.append(arbiter.step(tick, 0.0, 0.0, 0.0, 20.0).copy())
    return np.array(rows)


def beat(period, count, start=0, torque=2.0):
    return {start + i * period: [("guest", torque, 1.0)] for i in range(count)}


@pytest.mark.parametrize("period", [1, 10, 20, 100, 250, 1000])
def test_a_steady_guest_is_served_without_a_break_from_its_second_message_on(period):
    messages = beat(period, 6)
    rows = run(5 * period + 1, messages)
    assert np.all(rows[period:, SOURCE] == 1)
    assert not rows[period:, STALE].any()
    assert rows[-1, SILENCES] == (1 if period > 3 * SHORTEST else 0)


@given(period=st.integers(1, 1500), count=st.integers(4, 12))
@settings(max_examples=60, deadline=None)
def test_one_that_stops_is_silent_after_three_of_its_periods(period, count):
    last = period * (count - 1)
    believed = min(max(period, SHORTEST), LONGEST)
    rows = run(last + 3 * believed + 2, beat(period, count))
    assert not rows[last : last + 3 * believed + 1, STALE].any()
    assert rows[last + 3 * believed + 1, STALE] == 1.0
    assert rows[last + 3 * believed + 1, SOURCE] == 0


@pytest.mark.parametrize("pause", [40, 700, 5000])
def test_a_fast_guest_stays_fast_over_a_pause(pause):
    """One message after a pause must not make it a slow one that may keep silent for seconds."""
    first = beat(10, 20)
    back = 190 + pause
    rows = run(back + 40, {**first, back: [("guest", 2.0, 1.0)]})
    assert np.all(rows[back : back + 31, SOURCE] == 1)
    assert rows[back + 31, SOURCE] == 0


def test_a_guest_of_whom_nothing_is_known_counts_as_the_fastest():
    rows = run(40, beat(1, 1))
    assert np.all(rows[:31, SOURCE] == 1)
    assert rows[31, SOURCE] == 0


@given(odd=st.integers(1, 3000), place=st.integers(5, 9))
@settings(max_examples=40, deadline=None)
def test_one_odd_wait_changes_nothing(odd, place):
    rhythm, tick = Rhythm(SHORTEST, LONGEST), 0
    for i in range(12):
        rhythm.hear(tick)
        tick += odd if i == place else 100
        if i >= 3:
            assert rhythm.period == 100


def test_a_refused_message_tells_the_rhythm_but_is_not_heard():
    messages = beat(10, 300, torque=np.nan) | beat(1000, 3)
    rows = run(2100, messages)
    assert np.all(rows[1031:1041, SOURCE] == 0)


message = st.tuples(
    st.integers(0, 4000),
    st.sampled_from(["a", "b", "c"]),
    st.one_of(st.floats(-40.0, 40.0), st.floats()),
    st.one_of(st.sampled_from([-1.0, 0.0, 1.0, 2.0]), st.floats()),
)


@given(sent=st.lists(message, max_size=60))
@settings(max_examples=40, deadline=None)
def test_whatever_guests_send_the_limits_hold_and_all_ends_after_the_longest_wait(sent):
    messages = {}
    for tick, *what in sent:
        messages.setdefault(tick, []).append(tuple(what))
    end = max(messages, default=0) + 3 * LONGEST + 2
    rows = run(end + 600, messages)
    Rules(PARAMETERS).check(rows)
    assert np.all(rows[end:, SOURCE] == 0)
    assert rows[-1, APPLIED] == 0.0


def test_bounds_that_are_none_are_refused():
    values = {"overlay.guest_period": 0.5, "overlay.longest_guest_period": 0.1}
    with pytest.raises(ParameterError, match=r"longest_guest_period must not be less"):
        OverlayArbiter(PARAMETERS.with_values(values))
