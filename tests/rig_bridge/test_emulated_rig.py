"""The emulated rig behind each link: started, driven, made safe from both sides, taken up again."""

import math

import pytest
from rig_links import both_ends
from rig_loop import HOLD, SETTINGS, Loop

from rig_bridge.emulator.rig import WHEEL
from rig_bridge.safety.faults import Kind
from rig_bridge.safety.machine import State
from rig_bridge.signals import MEASURED
from rig_bridge.transport.registry import TRANSPORTS
from steering_core.parameters import load_parameters

WITHIN = 5


@pytest.fixture(params=sorted(TRANSPORTS))
def loop(request):
    with both_ends(request.param) as (bench_end, rig_end):
        yield Loop(bench_end, rig_end)


def pressures(reply):
    return reply.measured["left_pressure"], reply.measured["right_pressure"]


def ticks_to_safe(loop, **how):
    for tick in range(1, 12):
        reply = loop.tick(HOLD, **how)
        if reply.state is State.SAFE:
            assert set(reply.commands.values()) == {0.0}
            return tick
    raise AssertionError(f"not safe: {loop.bridge.report()}")


def test_pressures_follow_their_commands_once_the_checks_have_passed(loop):
    for _ in range(15):
        reply = loop.tick(HOLD)
        assert reply.state is State.CHECKING
    assert max(pressures(reply)) < 7e5, "no pressure before the checks have passed"
    loop.started(HOLD)
    for _ in range(100):
        reply = loop.tick(HOLD)
    left, right = pressures(reply)
    assert left == pytest.approx(1.0e6, abs=1.5e5)
    assert right == pytest.approx(2.0e6, abs=1.5e5)
    # 10 bar on 7 cm2 are 700 N. The rack keeps 130 N of friction, the column 40 N.
    assert reply.measured["rack_force"] == pytest.approx(700.0, abs=180.0)
    assert loop.bridge.report()["lost_frames"] == 0
    assert loop.bridge.report()["ticks"] > 250


def test_the_safe_state_lets_both_chambers_to_tank_and_leaves_the_wheel_free(loop):
    loop.started(HOLD)
    assert ticks_to_safe(loop, way=lambda frame: []) <= WITHIN
    for _ in range(100):
        reply = loop.tick(HOLD)
    assert reply.state is State.SAFE
    assert max(abs(value) for value in pressures(reply)) < 1e5
    assert abs(reply.measured["rack_force"]) < 50.0
    assert not loop.rig.watchdog.latched, "the bench made it safe, not the rig's watchdog"
    wheel = loop.rig.plant.out[0]
    loop.rig.safe[WHEEL] = 3.0  # a hand on the wheel
    for _ in range(300):
        loop.tick(HOLD)
    assert loop.rig.plant.out[0] > wheel + 0.2
    assert loop.rig.plant.out[6] > 0.2 / 130.9, "the rack follows the wheel mechanically"


def test_the_rig_makes_itself_safe_when_no_commands_come_and_says_so(loop):
    loop.started(HOLD)
    for _ in range(WITHIN):
        loop.tick(HOLD, answers=False)
    assert loop.rig.watchdog.latched
    assert ticks_to_safe(loop) <= 2
    assert loop.bridge.guard.fault is not None
    assert loop.bridge.guard.fault.kind is Kind.RIG
    for _ in range(20):
        loop.tick(HOLD)
    assert loop.rig.watchdog.latched, "commands alone do not end the rig's safe state"


def test_both_are_taken_up_again_after_a_reset_and_without_a_bump(loop):
    loop.started(HOLD)
    for _ in range(30):
        loop.tick(HOLD, answers=False)
    for _ in range(100):
        loop.tick(HOLD)
    assert (loop.state, loop.rig.watchdog.latched) == (State.SAFE, True)
    loop.tick(HOLD, reset=True)
    last = loop.rig.plant.out[3:5].copy()
    steepest = 0.0
    for _ in range(200):
        reply = loop.tick(HOLD)
        steepest = max(steepest, float(abs(loop.rig.plant.out[3:5] - last).max()))
        last = loop.rig.plant.out[3:5].copy()
    assert reply.state is State.RUNNING, loop.bridge.report()
    assert not loop.rig.watchdog.latched
    # Commands come in over 20 ticks here: 1.5 x 20 bar / 20, and what the valve adds to it.
    assert steepest < 5e5


def spoil(channel, change):
    index = list(MEASURED).index(channel)

    def way(frame):
        values = list(frame.values)
        values[index] = change(values[index])
        return [frame._replace(values=tuple(values))]

    return way


FAULTS = {
    "dead": lambda frame: [],
    "nan": spoil("torsion_bar_torque", lambda value: math.nan),
    "jump": spoil("left_pressure", lambda value: value + 8e6),
    "reversed": spoil("rack_force", lambda value: -value),
    "frozen": spoil("right_pressure", lambda value: 2.0e6),
    "repeated": lambda frame: [frame, frame],
    "clock": lambda frame: [frame._replace(rig_ns=frame.rig_ns + 10**6)],
    "own safe state": lambda frame: [frame._replace(rig_safe=True)],
}


@pytest.mark.parametrize("name", sorted(FAULTS))
def test_faults_on_the_link_reach_the_safe_state(loop, name):
    loop.started(HOLD)
    for _ in range(60):
        loop.tick(HOLD)
    assert loop.state is State.RUNNING
    assert ticks_to_safe(loop, way=FAULTS[name]) <= WITHIN


def test_reordered_frames_reach_the_safe_state(loop):
    loop.started(HOLD)
    held: list[object] = []

    def swapped(frame):
        if held:
            return [frame, held.pop()]
        held.append(frame)
        return []

    assert ticks_to_safe(loop, way=swapped) <= 2 * WITHIN, "a pair is swapped every other tick"


def test_a_rig_with_a_missing_channel_is_not_started(loop):
    for _ in range(130):
        loop.tick(HOLD, way=spoil("supply_pressure", lambda value: math.nan))
    assert loop.state is State.SAFE
    assert "supply_pressure" in str(loop.bridge.guard.fault)
    assert max(loop.rig.plant.out[3:5]) < 1e5


def test_the_emulated_rig_repeats_to_the_bit():
    runs = []
    for _ in range(2):
        with both_ends("udp") as (bench_end, rig_end):
            loop = Loop(bench_end, rig_end)
            runs.append([loop.tick(HOLD) for _ in range(150)])
    assert runs[0] == runs[1]


def test_the_rig_differs_from_the_data_sheet():
    nominal = load_parameters("nominal")
    assert all(nominal[name] != value for name, value in SETTINGS.parameters.items())


def test_late_ticks_and_late_frames_are_told_apart():
    with both_ends("udp") as (bench_end, rig_end):
        loop = Loop(bench_end, rig_end)
        loop.tick(HOLD)
        loop.bridge.latency.add(2_000_000)
        report = loop.bridge.report()
    assert (report["late"], report["late_frames"]) == (1, 0)
