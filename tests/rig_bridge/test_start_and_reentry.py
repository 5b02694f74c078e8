"""Checks before pressure is raised, the latch, and coming back without a bump."""

import math
from collections.abc import Mapping

import pytest
from healthy_rig import ASKED, Bench, emulated_rig

from rig_bridge.safety.faults import Kind
from rig_bridge.safety.machine import State
from rig_bridge.signals import MEASURED


def spoil(frame, channel, value):
    values = list(frame.values)
    values[list(MEASURED).index(channel)] = value
    return frame._replace(values=tuple(values))


def test_pressure_is_raised_after_the_checks_only():
    bench = Bench(emulated_rig(check_ticks=50, entry_ticks=10))
    states = []
    for _ in range(80):
        reply = bench.tick()
        states.append(reply.state)
        if reply.state is State.CHECKING:
            assert reply.commands == bench.guard.commands.safe
    assert states[:49] == [State.CHECKING] * 49
    assert states[49] is State.ENTERING
    assert states[49 + 10] is State.RUNNING
    assert states[-1] is State.RUNNING


@pytest.mark.parametrize("channel", list(MEASURED))
def test_a_missing_channel_is_named(channel):
    bench = Bench()
    for _ in range(150):
        bench.tick([spoil(bench.healthy(), channel, math.nan)])
    assert bench.state is State.SAFE
    assert bench.fault.kind is Kind.START_UP
    assert channel in str(bench.fault)


@pytest.mark.parametrize("channel", list(MEASURED))
def test_a_dead_channel_is_named(channel):
    bench = Bench()
    low, high = bench.guard.rig.channels[channel].plausible or (0.0, 0.0)
    for _ in range(150):
        bench.tick([spoil(bench.healthy(), channel, 0.5 * (low + high))])
    assert bench.fault.kind is Kind.START_UP
    assert channel in str(bench.fault)


def test_pressure_that_is_there_before_it_may_be_is_named():
    bench = Bench()
    for tick in range(150):
        bench.tick([spoil(bench.healthy(), "left_pressure", 6e6 + 100.0 * (tick % 7))])
    assert bench.fault.kind is Kind.START_UP
    assert "left_pressure" in str(bench.fault)
    assert "not plausible" in str(bench.fault)


def test_no_rig_at_all():
    bench = Bench()
    for _ in range(150):
        bench.tick([])
    assert bench.state is State.SAFE
    assert bench.fault.kind is Kind.START_UP


def test_one_bad_tick_starts_the_checks_again():
    bench = Bench(emulated_rig(check_ticks=50))
    bench.run(40)
    bench.tick([spoil(bench.healthy(), "rack_force", math.nan)])
    bench.run(30)
    assert bench.state is State.CHECKING
    bench.run(21)
    assert bench.state is not State.CHECKING


def test_the_commands_come_in_without_a_bump():
    """No command moves by more than the steepest part of the blend, 1.5 / entry_ticks, a tick."""
    entry = 100
    bench = Bench(emulated_rig(entry_ticks=entry))
    last: Mapping[str, float] = bench.guard.commands.safe
    for _ in range(250):
        sent = bench.tick().commands
        for name, value in sent.items():
            assert abs(value - last[name]) <= 1.51 / entry * abs(ASKED[name]) + 1e-12
        last = sent
    assert last == ASKED


def test_safe_until_reset_and_back_without_a_bump():
    bench = Bench(emulated_rig(entry_ticks=100)).started()
    bench.tick([], link_up=False)
    for _ in range(500):
        assert bench.tick().state is State.SAFE, "a healthy rig alone does not end the safe state"
    last = bench.tick(reset=True).commands
    assert bench.state is State.CHECKING
    bench.rig.moved = 0
    for _ in range(200):
        sent = bench.tick().commands
        for name, value in sent.items():
            assert abs(value - last[name]) <= 1.51 / 100 * abs(ASKED[name]) + 1e-12
        last = sent
    assert bench.tick().state is State.RUNNING
    assert bench.guard.fault is None


def test_a_reset_that_is_held_does_not_end_the_next_safe_state():
    bench = Bench()
    for _ in range(60):
        bench.tick(reset=True)
    assert bench.state is State.RUNNING
    bench.tick([], link_up=False, reset=True)
    for _ in range(100):
        assert bench.tick(reset=True).state is State.SAFE
    bench.tick(reset=False)
    assert bench.tick(reset=True).state is State.CHECKING


def test_a_rig_that_was_restarted_can_be_taken_up_again():
    """Its sequence numbers and its clock begin again: the reset takes them as they come."""
    bench = Bench().started()
    bench.rig.tick = 0
    bench.run(10)
    assert bench.state is State.SAFE
    bench.tick(reset=True)
    bench.rig.moved = 0
    assert bench.run(100).state is State.RUNNING, bench.guard.fault


def test_a_single_bad_sample_is_bridged():
    bench = Bench().started()
    good = bench.tick().measured["torsion_bar_torque"]
    reply = bench.tick([spoil(bench.healthy(), "torsion_bar_torque", math.nan)])
    assert reply.measured["torsion_bar_torque"] == good
    assert bench.run(20).state is State.RUNNING


def test_a_single_lost_or_repeated_frame_is_tolerated():
    bench = Bench().started()
    bench.tick([])
    bench.run(20)
    frame = bench.healthy()
    bench.tick([frame, frame])
    assert bench.run(20).state is State.RUNNING
    frames = bench.guard.measurements.frames
    assert (frames.repeated, frames.lost) == (1, 0)
    bench.healthy()  # lost on the way
    assert bench.run(20).state is State.RUNNING
    assert (frames.repeated, frames.lost) == (1, 1)


def test_the_first_fault_is_kept():
    bench = Bench().started()
    bench.tick([], link_up=False)
    bench.run(5)
    for _ in range(20):
        bench.tick([])
    assert bench.fault.kind is Kind.LINK
