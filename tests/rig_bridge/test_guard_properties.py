"""Whatever arrives and whatever is asked: what the rig is told stays within its limits."""

import math

from healthy_rig import ASKED, PERIOD_NS, Bench, emulated_rig
from hypothesis import given, settings
from hypothesis import strategies as st

from rig_bridge.safety.frame_watch import Frame
from rig_bridge.safety.guard import Guard
from rig_bridge.safety.machine import State
from rig_bridge.signals import MEASURED

RIG = emulated_rig(check_ticks=2, entry_ticks=3, check_timeout_ticks=30)
ANY = st.floats(allow_nan=True, allow_infinity=True)
VALUES = st.tuples(*(ANY for _ in MEASURED))
FRAMES = st.lists(
    st.builds(Frame, st.integers(0, 15), st.integers(0, 10**12), VALUES, st.booleans()), max_size=3
)
ASKING = st.fixed_dictionaries(dict.fromkeys(ASKED, ANY))
TICK = st.tuples(st.sampled_from(["healthy", "frames"]), FRAMES, ASKING, st.booleans())


def check_reply(guard, reply, last, was):
    """The invariants of every tick; ``last`` and ``was`` are the commands and state before it."""
    for name in RIG.commanded:
        channel, value = RIG.channels[name], reply.commands[name]
        assert channel.range[0] <= value <= channel.range[1]
        if reply.state in (State.CHECKING, State.SAFE):
            assert value == channel.safe
        else:
            step = channel.rate * 1e-3
            assert abs(value - last[name]) <= step * (1.0 + 1e-9)
    for name, value in reply.measured.items():
        low, high = RIG.channels[name].range
        assert math.isfinite(value)
        assert low <= value <= high
    if was is State.SAFE:
        assert reply.state in (State.SAFE, State.CHECKING)
    assert (guard.fault is not None) == (reply.state is State.SAFE)


@settings(max_examples=300, deadline=None)
@given(st.lists(TICK, max_size=40), st.integers(0, 1000))
def test_arbitrary_rig_and_bench(ticks, seed):
    bench = Bench(RIG, seed, bits=4)
    for kind, frames, asked, reset in ticks:
        last, was = bench.guard.commands.sent.copy(), bench.state
        given_frames = None if kind == "healthy" else frames
        reply = bench.tick(given_frames, asked, reset=reset)
        check_reply(bench.guard, reply, last, was)


@settings(max_examples=200, deadline=None)
@given(st.lists(ASKING, min_size=1, max_size=30), st.integers(0, 1000))
def test_arbitrary_commands_to_a_healthy_rig_that_runs(asking, seed):
    bench = Bench(RIG, seed)
    bench.started(10)
    for asked in asking:
        last, was = bench.guard.commands.sent.copy(), bench.state
        check_reply(bench.guard, bench.tick(asked=asked), last, was)
        finite = all(map(math.isfinite, asked.values()))
        if not finite:
            assert bench.state is State.SAFE


@settings(max_examples=200, deadline=None)
@given(st.lists(st.tuples(FRAMES, st.booleans()), max_size=60))
def test_without_a_healthy_rig_pressure_is_never_raised(ticks):
    guard = Guard(RIG, 4)
    for tick, (frames, reset) in enumerate(ticks):
        odd = [frame for frame in frames if not all(map(math.isfinite, frame.values))]
        reply = guard.step(odd, tick * PERIOD_NS, ASKED, reset=reset)
        assert reply.state in (State.CHECKING, State.SAFE)
        assert reply.commands == guard.commands.safe


def test_the_guard_reads_no_clock_and_repeats_to_the_bit():
    replies = []
    for _ in range(2):
        bench = Bench(seed=7).started(50)
        replies.append([bench.tick() for _ in range(50)])
    assert replies[0] == replies[1]
