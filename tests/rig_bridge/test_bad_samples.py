"""Bad samples in every pattern, at every channel and phase: bridged within a budget, else a fault.

The patterns are those that never faulted while single bad samples were bridged without a count.
"""

import math
from itertools import cycle, islice

import pytest
from healthy_rig import Bench, emulated_rig
from hypothesis import given, settings
from hypothesis import strategies as st

from rig_bridge.safety.bad_samples import BACK_TICKS, JumpWatch, SampleBudget
from rig_bridge.safety.channel_watch import ChannelWatch
from rig_bridge.safety.faults import Kind
from rig_bridge.safety.machine import State
from rig_bridge.signals import MEASURED

CHANNELS = tuple(MEASURED)
RIG = emulated_rig()
WATCHING = RIG.watching
WITHIN = 5
PATTERNS = {
    "alternating": (1, 0),
    "every_third": (1, 0, 0),
    "bursts_of_two": (1, 1, 0, 0, 0),
    "bursts_of_three": (1, 1, 1, 0, 0, 0, 0),
    "rare": (1, *[0] * 200),
}
AMOUNTS = {"no_number": math.nan, "beyond_rate": 2.5, "within_rate": 0.8}
"""Wrong by: no number at all, or so many times what the channel may change in a tick."""


def watch(channel):
    return ChannelWatch(channel, RIG.channels[channel], WATCHING)


def wrong_by(channel, amount):
    return amount if math.isnan(amount) else amount * RIG.channels[channel].rate * 1e-3


def ticks_to_fault(channel, pattern, amount, phase, limit=1000):
    """Return tick and fault of a channel that is right at rest but where the pattern says so."""
    seen = watch(channel)
    low, high = RIG.channels[channel].range
    level, count = 0.5 * (low + high), 2.0 * RIG.channels[channel].scale
    noise = cycle((0.0, count, -count, 2.0 * count))
    begun: int | None = None
    for tick, bad in enumerate(islice(cycle(pattern), phase, phase + limit)):
        value = level + next(noise) + (wrong_by(channel, amount) if bad and tick > 3 else 0.0)
        if begun is None and bad and tick > 3:
            begun = tick
        fault = seen.see(value)
        if fault is not None:
            assert begun is not None
            return tick - begun + 1, fault
    raise AssertionError(f"no fault in {limit} ticks")


@pytest.mark.parametrize("channel", CHANNELS)
@pytest.mark.parametrize("amount", AMOUNTS.values(), ids=AMOUNTS)
@pytest.mark.parametrize("name", PATTERNS)
def test_every_pattern_at_every_channel_and_phase_is_a_fault(name, amount, channel):
    pattern = PATTERNS[name]
    for phase in range(min(len(pattern), 12)):
        ticks, fault = ticks_to_fault(channel, pattern, amount, phase)
        assert fault.where == channel
        if fault.kind is Kind.BAD_SAMPLES:
            assert " in " in fault.text
        else:
            assert name.startswith("bursts")
            assert fault.kind in (Kind.RATE, Kind.RANGE, Kind.NOT_FINITE)
        # The third bad sample at the latest; of those that may be used, their way back.
        third = [k for k, bad in enumerate(pattern * 4) if bad][2]
        assert ticks <= third + len(pattern) + BACK_TICKS
        if name == "alternating":
            assert ticks <= WITHIN


@pytest.mark.parametrize("channel", CHANNELS)
@pytest.mark.parametrize("amount", AMOUNTS.values(), ids=AMOUNTS)
def test_a_single_bad_sample_twice_in_the_window_is_none(channel, amount):
    seen = watch(channel)
    low, high = RIG.channels[channel].range
    for tick in range(5000):
        bad = tick % (WATCHING.bridged_window_ticks // 2 + 1) == 100
        value = 0.5 * (low + high) + tick % 7 * 1e-3 * RIG.channels[channel].rate * 1e-3
        assert seen.see(value + (wrong_by(channel, amount) if bad else 0.0)) is None
    assert seen.bridged == (0 if amount == AMOUNTS["within_rate"] else 10)


@pytest.mark.parametrize("phase", range(4))
@pytest.mark.parametrize("bar", [10.0, 30.0, 55.0, 90.0, 150.0])
@pytest.mark.parametrize("side", ["left_pressure", "right_pressure", "supply_pressure"])
def test_a_pressure_that_is_wrong_in_every_second_sample_makes_the_rig_safe(side, bar, phase):
    """The whole guard, in the state running, at any phase of the pattern."""
    bench = Bench().started(147 + phase)
    index = CHANNELS.index(side)
    sign = -1.0 if side == "supply_pressure" else 1.0
    spoilt = cycle((True, False))

    def frames():
        frame = bench.healthy()
        values = list(frame.values)
        values[index] += sign * bar * 1e5 if next(spoilt) else 0.0
        return [frame._replace(values=tuple(values))]

    assert bench.ticks_to_safe(frames) <= WITHIN
    assert bench.fault.kind in (Kind.BAD_SAMPLES, Kind.DISAGREEMENT)


def test_the_budget_of_a_channel_s_own_row_counts():
    row = RIG.channels["rack_force"].model_copy(update={"bridged_samples": 0})
    seen = ChannelWatch("rack_force", row, WATCHING.model_copy(update={"confirm_ticks": 1}))
    seen.see(0.0)
    fault = seen.see(math.nan)
    assert fault is not None
    assert fault.kind is Kind.NOT_FINITE
    patient = RIG.channels["rack_force"].model_copy(update={"bridged_samples": 50})
    seen = ChannelWatch("rack_force", patient, WATCHING)
    faults = [seen.see(math.nan if k % 2 else 0.1 * k) for k in range(102)]
    assert [k for k, fault in enumerate(faults) if fault] == [101]


def test_a_step_a_slope_and_a_slow_return_are_no_jumps():
    steps = [0.0] * 5 + [9.0] * 20 + [0.0] * 20
    slope = (
        [3.0 * k for k in range(20)]
        + [60.0] * (BACK_TICKS + 1)
        + [3.0 * k for k in range(20, 0, -1)]
    )
    for values in (steps, slope):
        jumps = JumpWatch(1.0)
        assert [jumps.see(value, 1) for value in values] == [None] * len(values)


@given(st.lists(st.booleans(), max_size=400), st.integers(0, 5), st.integers(1, 60))
@settings(max_examples=200, deadline=None)
def test_the_budget_is_that_of_a_plain_count_over_the_window(bad, most, window):
    budget = SampleBudget(most, window)
    for tick, one in enumerate(bad):
        budget.pass_ticks(1)
        if one:
            inside = sum(bad[max(0, tick - window + 1) : tick + 1])
            assert budget.count() is (inside > most)


def test_a_reset_forgets_the_bad_samples():
    bench = Bench().started()
    seen = bench.guard.measurements.channels[0]
    seen.budget.count()
    seen.budget.count()
    bench.guard.measurements.reset()
    assert not seen.budget.at
    assert bench.state is State.RUNNING
