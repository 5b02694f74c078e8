"""Every injected fault makes the rig safe within five ticks, and says what it was."""

import math

import pytest
from healthy_rig import ASKED, PERIOD_NS, Bench, emulated_rig

from rig_bridge.safety.faults import Kind
from rig_bridge.safety.frame_watch import Frame
from rig_bridge.safety.machine import State
from rig_bridge.signals import MEASURED

WITHIN = 5
CHANNELS = tuple(MEASURED)


def spoiled(bench, channel, change):
    """Return a source of healthy frames but for one channel."""
    index = CHANNELS.index(channel)

    def frames():
        frame = bench.healthy()
        values = list(frame.values)
        values[index] = change(values[index])
        return [frame._replace(values=tuple(values))]

    return frames


@pytest.fixture
def bench():
    return Bench().started()


def test_a_healthy_rig_never_trips():
    bench = Bench().started(8000)  # twelve periods of the swing
    assert bench.guard.fault is None
    assert bench.state is State.RUNNING


@pytest.mark.parametrize("channel", CHANNELS)
@pytest.mark.parametrize("bad", [math.nan, math.inf, -math.inf])
def test_no_number(bench, channel, bad):
    assert bench.ticks_to_safe(spoiled(bench, channel, lambda _: bad)) <= WITHIN
    assert bench.fault.kind is Kind.NOT_FINITE
    assert bench.fault.where == channel


@pytest.mark.parametrize("channel", CHANNELS)
def test_out_of_range(bench, channel):
    beyond = bench.guard.rig.channels[channel].range[1] * 1.01
    assert bench.ticks_to_safe(spoiled(bench, channel, lambda _: beyond)) <= WITHIN
    assert (bench.fault.kind, bench.fault.where) == (Kind.RANGE, channel)


@pytest.mark.parametrize("channel", CHANNELS)
def test_jump(bench, channel):
    entry = bench.guard.rig.channels[channel]
    index = CHANNELS.index(channel)
    now = bench.healthy().values[index]
    jump = 3.0 * entry.rate * 1e-3 + 0.05 * abs(now)
    jump = jump if now + jump < entry.range[1] else -jump
    assert bench.ticks_to_safe(spoiled(bench, channel, lambda value: value + jump)) <= WITHIN
    assert bench.fault.kind in (Kind.RATE, Kind.DISAGREEMENT)


@pytest.mark.parametrize("channel", CHANNELS)
def test_frozen(bench, channel):
    last = bench.guard.measurements.channels[CHANNELS.index(channel)].seen
    assert bench.ticks_to_safe(spoiled(bench, channel, lambda _: last)) <= WITHIN
    assert (bench.fault.kind, bench.fault.where) == (Kind.FROZEN, channel)


@pytest.mark.parametrize("channel", CHANNELS)
def test_reversed_sign(bench, channel):
    if channel in ("steering_wheel_speed", "rack_speed"):
        bench = Bench().started(313)  # near the middle, where the speed is largest
    if channel == "rack_force":
        asked = ASKED | {"load_force": 1500.0}
        for _ in range(50):
            bench.tick(asked=asked)
    else:
        asked = ASKED
    source = spoiled(bench, channel, lambda value: -value)
    assert bench.ticks_to_safe(source, asked=asked) <= WITHIN
    kinds = (Kind.DISAGREEMENT, Kind.RATE, Kind.RANGE)
    assert bench.fault.kind in kinds


@pytest.mark.parametrize("sign_channel", ["steering_wheel_angle", "torsion_bar_torque"])
def test_reversed_sign_that_was_there_all_along_is_a_disagreement(sign_channel):
    """No jump gives it away: the wheel starts from the middle with the sign wrong already."""
    bench = Bench()
    source = spoiled(bench, sign_channel, lambda value: -value)
    for _ in range(500):
        if bench.tick(source()).state is State.SAFE:
            break
    assert bench.guard.fault is not None
    assert bench.fault.kind is Kind.DISAGREEMENT


@pytest.mark.parametrize("side", ["left", "right"])
def test_a_pressure_that_does_not_follow_its_command(bench, side):
    for _ in range(30):
        bench.tick(asked=ASKED | {f"{side}_reference_pressure": 9e6})
    stuck = spoiled(bench, f"{side}_pressure", lambda value: value - 5e6)
    assert bench.ticks_to_safe(stuck, asked=ASKED | {f"{side}_reference_pressure": 9e6}) <= WITHIN
    assert (bench.fault.kind, bench.fault.where) == (
        Kind.DISAGREEMENT,
        f"{side}_valve",
    )


def test_stale_data(bench):
    assert bench.ticks_to_safe(list) <= WITHIN
    assert bench.fault.kind is Kind.STALE


def test_lost_link(bench):
    assert bench.ticks_to_safe(list, link_up=False) == 1
    assert bench.fault.kind is Kind.LINK


def test_duplicated_frames(bench):
    def twice():
        frame = bench.healthy()
        return [frame, frame]

    assert bench.ticks_to_safe(twice) <= WITHIN
    assert bench.fault.kind is Kind.FRAMES


def test_only_old_frames(bench):
    frame = bench.healthy()
    bench.tick([frame])
    assert bench.ticks_to_safe(lambda: [frame]) <= WITHIN
    assert bench.fault.kind in (Kind.FRAMES, Kind.STALE)


def test_reordered_frames(bench):
    held: list[Frame] = []

    def swapped():
        if held:
            return [held.pop()]
        held.append(bench.healthy())
        return [bench.healthy()]

    assert bench.ticks_to_safe(swapped) <= WITHIN
    assert bench.fault.kind is Kind.FRAMES


def test_clock_that_jumps(bench):
    def late():
        frame = bench.healthy()
        return [frame._replace(rig_ns=frame.rig_ns + 500_000)]

    assert bench.ticks_to_safe(late) == 1
    assert bench.fault.kind is Kind.CLOCK_STEP


@pytest.mark.parametrize("drift", [-0.01, 0.01])
def test_clock_drift_is_found_five_ticks_after_it_exceeds_its_limit(bench, drift):
    watching = bench.guard.rig.watching
    excess = (abs(drift) - watching.clock_drift) * 1e-3
    ticks_to_limit = math.ceil(watching.clock_offset_s / excess)
    exact = float(bench.now_ns)
    for tick in range(ticks_to_limit + WITHIN):
        exact += PERIOD_NS * (1.0 + drift)
        bench.now_ns = round(exact) - PERIOD_NS
        if bench.tick().state is State.SAFE:
            assert tick >= ticks_to_limit - 1
            break
    assert bench.guard.fault is not None
    assert bench.fault.kind is Kind.CLOCK_DRIFT


def test_allowed_drift_is_followed_for_ever(bench):
    for _ in range(20_000):
        bench.now_ns += 500  # 500 ppm
        bench.tick()
    assert bench.state is State.RUNNING, bench.guard.fault


def test_rig_reports_its_own_safe_state(bench):
    assert bench.ticks_to_safe(lambda: [bench.healthy()._replace(rig_safe=True)]) == 1
    assert bench.fault.kind is Kind.RIG


@pytest.mark.parametrize("name", list(ASKED))
@pytest.mark.parametrize("bad", [math.nan, math.inf])
def test_command_is_no_number(bench, name, bad):
    source = lambda: [bench.healthy()]  # noqa: E731
    assert bench.ticks_to_safe(source, asked=ASKED | {name: bad}) == 1
    assert (bench.fault.kind, bench.fault.where) == (Kind.COMMAND_NOT_FINITE, name)


def test_dead_node_sends_no_new_commands(bench):
    for age in range(1, WITHIN + 1):
        if bench.tick(asked_age=age).state is State.SAFE:
            break
    assert bench.fault.kind is Kind.COMMAND_STALE


def test_faults_while_the_commands_come_in_count_as_well():
    bench = Bench(emulated_rig(entry_ticks=500))
    while bench.state is State.CHECKING:
        bench.tick()
    bench.run(100)
    assert bench.state is State.ENTERING
    assert bench.ticks_to_safe(list) <= WITHIN
