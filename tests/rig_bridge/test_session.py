"""One run with the emulated rig, tick by tick: checks, commands of rest, ticks, faults, report."""

import math
from typing import Any

import pytest
from healthy_rig import EMULATED, PERIOD_NS, emulated_rig
from rig_links import both_ends
from rig_loop import HOLD, SETTINGS

from rig_bridge.clock_offset import WINDOW, ClockOffset
from rig_bridge.emulator.rig import EmulatedRig
from rig_bridge.rig_file import load_rig
from rig_bridge.session import FIRST_COMMANDS_TICKS, Session, columns_of
from rig_bridge.shipped import find_rig, shipped_rigs
from rig_bridge.transport.registry import check_link
from steering_core.errors import BenchError
from steering_lockstep.signals import PLACES

WITHIN = 5
MOST = 1000
RIG = emulated_rig(check_ticks=20, entry_ticks=10)
VALUES = [HOLD[name] for name in RIG.commanded]


class Run:
    """A session and the rig at the other end; ``tick`` is a period of the rig."""

    def __init__(self, bench_end, rig_end, on_fault="end"):
        columns = [PLACES[name] for name in RIG.commanded]
        self.session = Session(RIG, columns, lambda: bench_end, on_fault)
        self.rig = EmulatedRig(RIG, SETTINGS, rig_end.sequence_bits)
        self.rig_end = rig_end
        self.session.open()
        self.now_ns = 0
        self.session.open_bridge.clock = lambda: self.now_ns
        self.ticks = []

    def tick(self, values=VALUES, age=0, late=None, send=True):
        frame = self.rig.measure()
        if send:
            self.rig_end.send_frame(frame)
        self.now_ns += PERIOD_NS
        self.ticks += self.session.receive(MOST)
        self.session.answer(max(len(self.ticks) - 1, 0), values, age, late)
        self.rig.step(self.rig_end.receive_demands(1.0))

    def pile(self, periods):
        """Let the rig go on while nobody looks: its frames come together then."""
        self.session.open_bridge.reset_report()
        for _ in range(periods):
            self.rig_end.send_frame(self.rig.measure())
            self.rig.step([])

    def started(self, ticks=20):
        while len(self.ticks) < ticks:
            self.tick()
        return self

    def ticks_to_failure(self, **how):
        for count in range(1, 20):
            self.tick(**how)
            if self.session.failure:
                return count
        raise AssertionError(self.session.report())


@pytest.fixture
def run():
    with both_ends("udp", RIG) as (bench_end, rig_end):
        yield Run(bench_end, rig_end)


def test_tick_0_comes_when_the_rig_runs_at_the_commands_of_rest(run):
    for _ in range(29):
        run.tick()
        assert not run.ticks
        assert run.session.preparing
    run.started(5)
    assert not run.session.preparing
    assert run.session.status() == ("ok", "running")
    assert run.rig.plant.out[4] > 5e5, "pressures are those of rest already"
    changes = [(c["tick"], c["to"]) for c in run.session.report()["changes"]]
    assert changes == [(None, "checking"), (None, "entering"), (None, "running")]


def test_a_lost_frame_is_a_tick_with_the_values_before_it(run):
    run.started(20)
    run.tick(send=False)
    run.tick()
    assert len(run.ticks) == 22, "consecutive, and still the rig's periods"
    assert run.ticks[20] == run.ticks[19]
    assert run.ticks[21] != run.ticks[20]
    report = run.session.report()
    assert (report["lost_frames"], report["lost_at"]) == (1, [21])


def test_frames_that_come_together_have_a_latency_each(run):
    run.started(20)
    run.pile(3)
    run.now_ns += 3 * PERIOD_NS
    assert len(run.session.receive(MOST)) == 3
    for ahead in (2, 1, 0):
        run.now_ns += 400_000
        run.session.answer(22 - ahead, VALUES, 0, None, ahead)
    report = run.session.report()
    assert (report["ticks"], report["late"]) == (3, 1), "0.4, 0.8 and 1.2 ms"
    assert report["max"] == pytest.approx(1.2e-3)


def test_what_comes_after_the_last_tick_is_no_tick(run):
    """A machine that was held up has several periods at once, and the run may end among them."""
    run.started(20)
    run.pile(3)
    assert len(run.session.receive(2)) == 2
    for ahead in (1, 0):
        run.session.answer(21 - ahead, VALUES, 0, None, ahead)
    assert run.session.report()["ticks"] == 2


def test_old_commands_make_the_rig_safe_and_name_who_owes_them(run):
    run.started()
    run.tick(age=3, late="/driver/torque of node 'driver'")
    assert run.session.failure is None
    run.tick(age=4, late="/driver/torque of node 'driver'")
    assert "/driver/torque of node 'driver': no new commands (for 4 ticks)" in str(
        run.session.failure
    )
    assert run.session.report()["held"] == 2


def test_the_first_commands_may_take_a_while():
    with both_ends("udp", RIG) as (bench_end, rig_end):
        run = Run(bench_end, rig_end)
        while not run.ticks:
            run.tick(age=1, late="/driver/torque")
        for age in range(2, FIRST_COMMANDS_TICKS):
            run.tick(age=age, late="/driver/torque")
        assert run.session.failure is None
        assert run.ticks_to_failure(age=FIRST_COMMANDS_TICKS, late="/driver/torque") <= 2


FAULTS: dict[str, dict[str, Any]] = {
    "a command that is no number": {"values": [math.nan, *VALUES[1:]]},
    "a silent rig": {"send": False},
}


@pytest.mark.parametrize("name", FAULTS)
def test_faults_end_the_run_in_the_safe_state(run, name):
    run.started()
    assert run.ticks_to_failure(**FAULTS[name]) <= WITHIN
    assert run.session.state == "safe"
    assert run.session.status().level == "error"
    assert run.session.report()["changes"][-1]["tick"] == len(run.ticks) - 1


def test_a_reset_is_for_the_safe_state_only():
    with both_ends("udp", RIG) as (bench_end, rig_end):
        run = Run(bench_end, rig_end, on_fault="hold").started()
        assert run.session.reset()[0] is False
        for _ in range(5):
            run.tick(send=False)
        assert (run.session.state, run.session.failure) == ("safe", None)
        assert run.session.reset()[0] is True
        for _ in range(200):
            run.tick()
        assert run.session.state == "running", run.session.report()


def test_the_end_leaves_the_rig_safe(run):
    run.started(60)
    run.session.close()
    run.session.close()
    for _ in range(80):
        run.rig.measure()
        run.rig.step([])
    assert max(run.rig.plant.out[3:5]) < 1e5
    assert run.session.report()["state"] == "running", "as it was at the end"


def test_a_command_that_nothing_gives_is_refused():
    known = [PLACES[name] for name in RIG.commanded if name != "left_solenoid_force"]
    with pytest.raises(BenchError, match="solenoid_force of /valve/left/command"):
        columns_of(RIG, known)


def test_drift_and_transit_are_told_apart():
    offset, drift = ClockOffset(), 3e-5
    late = [offset.see(k * PERIOD_NS, round(k * PERIOD_NS * (1 + drift))) for k in range(WINDOW)]
    assert max(late) == 0
    assert offset.drift() is None
    for k in range(WINDOW, 4 * WINDOW):
        offset.see(k * PERIOD_NS, round(k * PERIOD_NS * (1 + drift)) + 40_000 * (k % 3))
    assert offset.drift() == pytest.approx(drift, rel=0.05)
    assert offset.see(5 * WINDOW * PERIOD_NS, 5 * WINDOW * PERIOD_NS + 2_000_000) > 1_500_000


@pytest.mark.parametrize("name", shipped_rigs())
def test_shipped_rigs_fit_their_links(name):
    path = find_rig(name)
    rig = load_rig(path)
    for kind in ("udp", "can"):
        check_link(kind, rig, path.parent)
    assert rig.emulator is None or (path.parent / rig.emulator).exists()


def test_an_unknown_rig_is_refused_with_the_nearest():
    with pytest.raises(BenchError, match="emulated"):
        find_rig("emulatd")
    with pytest.raises(BenchError, match="no rig's file"):
        find_rig(str(EMULATED.parent / "nowhere.yaml"))
