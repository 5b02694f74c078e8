"""What comes in through any door is what the bag holds, as far as its channels and logger go."""

from collections import Counter
from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from steering_core.errors import BenchError
from steering_core.parameters import load_parameters
from steering_diagnosis.benchmark.bags import record_of
from steering_diagnosis.benchmark.baseline import baseline
from steering_diagnosis.benchmark.by_door import ROWS, by_door, rows_of
from steering_diagnosis.benchmark.cases import draw_case, system_of
from steering_diagnosis.benchmark.doors.channel_sets import LACKABLE, RIG, checked, lacking_in
from steering_diagnosis.benchmark.doors.door import KINDS, Door, draw_door
from steering_diagnosis.benchmark.doors.logger import FEW_DIGITS, Logger, rounded
from steering_diagnosis.benchmark.doors.write import paths, write_mapping, write_through
from steering_diagnosis.benchmark.methods import call
from steering_diagnosis.benchmark.missing import costs, without_each
from steering_diagnosis.benchmark.runner import Job, plan, run_jobs, solve
from steering_diagnosis.benchmark.scoring import Judgement, judge, rates
from steering_diagnosis.benchmark.sealed import Sealed
from steering_diagnosis.benchmark.truth.course import draw_course
from steering_diagnosis.benchmark.truth.disturbance import RESOLUTION, disturbance
from steering_diagnosis.benchmark.truth.run import run_closed_loop
from steering_diagnosis.benchmark.truth.specimen import draw_specimen
from steering_diagnosis.data.read import read_record

NOMINAL = load_parameters()
SYSTEMS = ("open_centre", "closed_centre")
NEAR = 6
"""Ticks within which drift, jitter and single losses may move a sample."""


@pytest.fixture(scope="module")
def cases():
    """Signals and the bag's own record of a short case, by valve system."""
    found = {}
    for system in SYSTEMS:
        random = np.random.default_rng(7)
        course = draw_course(random, 2.6, "weave", "bicycle")
        specimen, noise = draw_specimen(NOMINAL, random), disturbance(random, len(course.angle))
        closed = system == "closed_centre"
        signals = run_closed_loop(specimen, NOMINAL, course, closed, noise, RESOLUTION)
        bag = record_of(signals, NOMINAL, system, "bicycle", "bag")
        found[system] = SimpleNamespace(signals=signals, bag=bag, system=system)
    return found


def come_in(door, case, folder):
    at = paths(door, folder, "record")
    write_through(door, at.record, case.signals, NOMINAL, case.system, "bicycle")
    if at.mapping is not None:
        write_mapping(door, at.mapping, case.signals, case.system)
    return read_record(at.record, at.mapping)


def beside(values, near):
    """Return least and largest of the samples up to ``near`` ticks away."""
    padded = np.pad(values, near, mode="edge")
    windows = np.lib.stride_tricks.sliding_window_view(padded, 2 * near + 1)
    return windows.min(axis=1), windows.max(axis=1)


@pytest.mark.parametrize("kind", KINDS)
@settings(max_examples=6, deadline=None, suppress_health_check=list(HealthCheck))
@given(seed=st.integers(0, 10**6), system=st.sampled_from(SYSTEMS), groups=st.booleans())
def test_every_door_gives_the_bags_record(kind, cases, tmp_path_factory, seed, system, groups):
    case = cases[system]
    drawn = draw_door(seed, kind, draw_door(seed).lacking if groups else None)
    record = come_in(drawn, case, tmp_path_factory.mktemp("door"))
    gone = {c for g in lacking_in(system, drawn.lacking) for c in LACKABLE[g]}
    assert set(record.channels) == set(case.bag.channels) - gone
    assert record.valve_system == system
    near = NEAR if drawn.logger.ways else 0
    for name, values in record.channels.items():
        low, high = beside(case.bag[name], near)
        digits = 0.5 * 10.0 ** (1 - FEW_DIGITS) if drawn.logger.digits else 1e-8
        room = digits * np.abs(case.bag[name]).max()
        low, high = low[: len(values)] - room, high[: len(values)] + room
        there = np.isfinite(values)
        assert there.mean() > 0.75
        assert np.all((values >= low)[there] & (values <= high)[there]), name


def test_the_baseline_takes_what_every_door_gives(cases, tmp_path):
    for kind, system, lacking in [
        ("bag", "open_centre", ("driver_torque", "left_pressure")),
        ("csv", "closed_centre", RIG),
    ]:
        door = Door(kind, lacking, Logger(gaps=((0.5, 0.1),)) if kind == "csv" else Logger())
        come_in(door, cases[system], tmp_path)
        at = paths(door, tmp_path, "record")
        assert call(baseline, replace(at, holdout=at.record))["verdict"] in ("clean", "named")


def test_a_gap_of_the_logger_is_a_gap_of_the_record(cases, tmp_path):
    door = Door("csv", (), Logger(start=2000.0, gaps=((0.5, 0.1),)))
    record = come_in(door, cases["open_centre"], tmp_path)
    lost = ~np.isfinite(record["left_pressure"])
    assert lost.sum() == pytest.approx(100, abs=2)
    assert np.flatnonzero(lost)[0] == pytest.approx(1300, abs=2)


def test_four_digits_are_four():
    assert rounded(np.array([123456.0, -0.00123456, 0.0, 9.9996]), 4) == pytest.approx(
        [123500.0, -0.001235, 0.0, 10.0], rel=1e-12
    )


def test_a_door_is_drawn_from_the_seed_and_all_come_up():
    doors = [draw_door(seed) for seed in range(400)]
    assert doors == [draw_door(seed) for seed in range(400)]
    kinds = Counter(door.kind for door in doors)
    assert min(kinds[kind] for kind in KINDS) > 60
    lacking = Counter(door.lacking for door in doors)
    assert lacking[()] > 60
    assert lacking[RIG] > 60
    assert all(any(g in door.lacking for door in doors) for g in LACKABLE)
    ways = Counter(way for door in doors for way in door.logger.ways)
    assert min(ways.values()) > 40
    rows = {
        r
        for d in doors
        for r in rows_of({"kind": d.kind, "lacking": d.lacking, "ways": d.logger.ways})
    }
    assert rows == set(ROWS)


def test_forcing_one_thing_leaves_the_others_as_drawn():
    drawn = next(d for d in map(draw_door, range(99)) if d.kind == "mdf" and d.logger.ways)
    seed = next(s for s in range(99) if draw_door(s) == drawn)
    assert draw_door(seed, "matlab") == Door("matlab", drawn.lacking, drawn.logger, drawn.way)
    assert draw_door(seed, lacking=["speeds"]).logger == drawn.logger
    assert draw_door(seed, "bag") == Door()
    assert draw_door(seed, "csv", ["none"]).lacking == ()


@pytest.mark.parametrize(
    ("kind", "lacking", "what"),
    [
        ("floppy", None, "door"),
        ("csv", ["spedes"], "speeds"),
        ("csv", ["valve_commands", "left_pressure"], "both chamber pressures"),
    ],
)
def test_what_is_no_door_is_refused(kind, lacking, what):
    with pytest.raises(BenchError, match=what):
        draw_door(0, kind, lacking)


def test_only_a_gear_with_valve_commands_can_lack_them():
    groups = checked(["valve_commands", "speeds"])
    assert lacking_in("open_centre", groups) == ("speeds",)
    assert lacking_in("closed_centre", groups) == groups


def test_the_specimen_does_not_depend_on_its_door():
    jobs = plan(20, 3, doors=draw_door)
    assert [(j.kind, j.seed, j.effect) for j in jobs] == [
        (j.kind, j.seed, j.effect) for j in plan(20, 3)
    ]
    assert len({job.case for job in jobs}) == len(jobs)
    assert system_of("clean", 3, None) == draw_case("clean", 3, seconds=2.0).sealed.valve_system


def test_an_error_ends_no_run_is_counted_and_shown(tmp_path, monkeypatch):
    def fails(method, at):
        assert at.mapping is not None
        raise ValueError("the replay ran away")

    monkeypatch.setattr("steering_diagnosis.benchmark.runner.call", fails)
    monkeypatch.setattr(
        "steering_diagnosis.benchmark.runner.draw_case",
        lambda kind, seed, effect, holdout: draw_case(kind, seed, effect, 2.5, holdout),
    )
    job = Job("clean", 7, None, Door("matlab", ("speeds",)))
    (judgement,) = run_jobs([job], "baseline", tmp_path, None)
    assert judgement.failure == "ValueError: the replay ran away"
    row = {r.what: r for r in by_door([judgement])}["without the speeds"]
    assert (row.cases, row.errors) == (1, 1)
    assert solve(job, "baseline", tmp_path) == judgement


def judged(case, lacking, unseen=(), right=("rack_mass",), wrong=(), kind="visible"):
    door = {"kind": "bag", "lacking": list(lacking), "ways": []}
    return Judgement(
        case, kind, ("rack_mass",), "named", right=tuple(right), alone=tuple(right),
        wrong=tuple(wrong), door=door, unseen=tuple(unseen),
    )  # fmt: skip


def test_what_channels_do_not_show_is_not_missed_but_may_not_be_misnamed():
    seen, unseen = (
        judged("a", ()),
        judged("b", RIG, ["rack_mass"], right=(), wrong=["solenoid_lag"]),
    )
    found = {rate.what: rate for rate in rates([seen, unseen])}
    assert found["one effect: alone and right"].n == 1
    assert found["not shown by its channels: a wrong name"].value == 1.0
    row = {r.what: r for r in by_door([seen, unseen])}["a rig's seven channels"]
    assert (row.asked, row.unseen, row.wrong, row.alarms) == (0, 1, 1, 0)


def test_what_several_known_effects_imitate_counts_nowhere():
    """A bending rack, through few channels, is a heavier one with some friction."""
    door = {"kind": "bag", "lacking": ["speeds"], "ways": []}
    sealed = Sealed("outside-1", "outside", 1, "open_centre", "steps", "bicycle",
        {"rack_bending": 11.0}, mistaken={"rack_bending": []},
        ratios={"rack_bending": 46.0}, door=door, unseen=["rack_bending"])  # fmt: skip
    said = {"verdict": "named", "causes": [{"effect": "rack_mass"}]}
    assert all(rate.n == 0 for rate in rates([judge(said, sealed)]))
    assert all(row.wrong == 0 for row in by_door([judge(said, sealed)]))
    faint = replace(sealed, ratios={"rack_bending": 1.0})
    found = {rate.what: rate for rate in rates([judge(said, faint)])}
    assert found["not shown by its channels: a wrong name"].value == 1.0


def test_the_cost_of_a_missing_channel_is_counted_over_the_same_specimens():
    whole = [judged("x", ()), judged("y", ())]
    without = [
        judged("x.bag", ["speeds"], right=()),
        judged("y.bag", ["speeds"], ["rack_mass"], right=()),
    ]
    alone = judged("z.bag", ["speeds"])
    found = {c.what: c for c in costs([*whole, *without, alone])}["without the speeds"]
    assert (found.hidden, found.shown, found.right, found.lost) == (2, 1, 0, 2)


def test_each_specimen_is_compared_with_every_set_that_it_can_lack():
    jobs = without_each([Job("clean", seed) for seed in range(6)])
    sets = {seed: [j.door.lacking for j in jobs if j.seed == seed] for seed in range(6)}
    for seed, lacking in sets.items():
        closed = system_of("clean", seed, None) == "closed_centre"
        assert len(lacking) == len(set(lacking)) == (7 if closed else 6)
        assert any("valve_commands" in groups for groups in lacking) == closed
