"""The rig's own watchdog: whatever comes, nothing is obeyed that is not fresh and within range."""

import math

import pytest
from hypothesis import given
from hypothesis import strategies as st
from rig_links import COMMANDED, DEMAND, RIG

from rig_bridge.emulator.watchdog import RigWatchdog
from rig_bridge.transport.packets import Demand, Order

ROWS = RIG.rows(RIG.commanded)


def watchdog(bits=32):
    return RigWatchdog(ROWS, 5, bits)


def run_order(k, order=Order.RUN, values=COMMANDED):
    return [DEMAND._replace(sequence=k, order=order, values=values)]


def test_nothing_is_obeyed_before_the_order_to_run():
    dog = watchdog()
    assert dog.tick([]) is None
    assert dog.tick(run_order(0, Order.HOLD)) is None
    assert dog.tick(run_order(1, Order.ARM)) is None
    assert dog.tick(run_order(2)) == COMMANDED


def test_silence_is_latched_after_five_ticks_until_armed():
    dog = watchdog()
    dog.tick(run_order(0))
    assert [dog.tick([]) is None for _ in range(6)] == [False] * 4 + [True] * 2
    assert dog.latched
    assert dog.tick(run_order(1)) is None
    assert dog.tick(run_order(2, Order.HOLD)) is None
    assert dog.latched
    assert dog.tick(run_order(3, Order.ARM)) is None
    assert dog.tick(run_order(4)) == COMMANDED


def test_old_and_repeated_commands_do_not_keep_it_going():
    dog = watchdog()
    dog.tick(run_order(100))
    for _ in range(6):
        dog.tick(run_order(100) + run_order(99))
    assert dog.latched


@pytest.mark.parametrize("bad", [math.nan, math.inf, 1e12])
def test_a_command_out_of_range_is_latched(bad):
    dog = watchdog()
    dog.tick(run_order(0))
    assert dog.tick(run_order(1, values=(bad, *COMMANDED[1:]))) is None
    assert dog.latched


def test_the_counter_of_the_link_wraps():
    dog = watchdog(bits=4)
    for k in range(100):
        assert dog.tick(run_order(k % 16)) == COMMANDED


ANY = st.floats(allow_nan=True, allow_infinity=True)
DEMANDS = st.builds(
    Demand,
    st.integers(0, 15),
    st.integers(0, 15),
    st.sampled_from(Order),
    st.one_of(st.just(COMMANDED), st.tuples(*(ANY for _ in COMMANDED))),
)


@given(st.lists(st.lists(DEMANDS, max_size=2), max_size=60))
def test_any_commands(ticks):
    dog = watchdog(bits=4)
    silent = 0
    for demands in ticks:
        was = dog.latched
        obeyed = dog.tick(demands)
        silent = 0 if demands else silent + 1
        if obeyed is not None:
            assert silent < 5
            assert not dog.latched
            for row, value in zip(ROWS, obeyed, strict=True):
                low, high = row.range
                assert low - row.scale <= value <= high + row.scale
        if was and not dog.latched:
            assert any(demand.order is Order.ARM for demand in demands)
