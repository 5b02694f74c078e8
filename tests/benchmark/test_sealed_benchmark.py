"""Cases, their seal, what a bag holds, and the scorer on reports written by hand."""

import json
from collections import Counter
from dataclasses import replace

import numpy as np
import pytest
from written_reports import ONE, cause, report

from steering_bringup.bags import read_bag
from steering_core.errors import BenchError
from steering_diagnosis.benchmark.bags import record_of, write_case
from steering_diagnosis.benchmark.baseline import baseline
from steering_diagnosis.benchmark.cases import draw_case, read_sealed
from steering_diagnosis.benchmark.methods import load_function
from steering_diagnosis.benchmark.runner import Job, plan, solve
from steering_diagnosis.benchmark.scoring import confusion, judge, rates
from steering_diagnosis.benchmark.truth.listed import LISTED
from steering_diagnosis.benchmark.truth.outside import OUTSIDE
from steering_diagnosis.data.bag import record_from_bag
from steering_plant.effects import EFFECTS


def test_the_right_name_alone_with_its_parameter():
    estimate = {"value": 11.0, "low": 9.5, "high": 12.5, "unit": "kg"}
    j = judge(report(cause("rack_mass", added=estimate)), ONE)
    assert (j.right, j.alone, j.wrong) == (("rack_mass",), ("rack_mass",), ())
    assert j.errors == {"rack_mass.added": pytest.approx(0.1)}
    assert j.covered == {"rack_mass.added": True}
    assert j.half_widths == {"rack_mass.added": pytest.approx(0.15)}


@pytest.mark.parametrize(
    ("causes", "right", "alone", "wrong"),
    [
        ([cause("rack_mass", "rack_viscous_damping")], True, False, False),
        ([cause("rack_viscous_damping", "rack_mass")], True, False, False),
        ([cause("rack_mass", "column_friction")], False, False, True),
        ([cause("rack_viscous_damping")], False, False, False),
        ([cause("column_friction")], False, False, True),
        ([cause("rack_mass"), cause("column_friction")], True, True, True),
        ([], False, False, False),
    ],
)
def test_groups_and_wrong_names(causes, right, alone, wrong):
    j = judge(report(*causes), ONE)
    assert (bool(j.right), bool(j.alone), bool(j.wrong)) == (right, alone, wrong)


def test_a_true_name_too_small_to_be_seen_is_not_wrong_but_another_is():
    small = replace(ONE, kind="invisible", mistaken={"rack_mass": []})
    assert not judge(report(cause("rack_mass")), small).wrong
    assert judge(report(cause("column_friction")), small).wrong


def test_outside_the_catalogue():
    outside = replace(ONE, kind="outside", sizes={"bent_rack": 1.0}, parameters={}, mistaken={})
    said = judge(report(verdict="unexplained", unexplained=[{"balance": "rack force"}]), outside)
    assert said.unexplained
    assert not said.wrong
    assert judge(report(cause("rack_mass")), outside).wrong


def test_the_gain_counts_what_is_above_the_noise():
    signal = {"noise_holdout": 1.0, "rmse_refitted_holdout": 3.0, "rmse_extended_holdout": 1.5}
    j = judge(report(cause("rack_mass"), signals={"torsion_bar_torque": signal}), ONE)
    assert j.gain == pytest.approx(1.0 - 1.25 / 8.0)


def test_rates_have_intervals_and_targets():
    good, bad = judge(report(cause("rack_mass")), ONE), judge(report(), ONE)
    first = rates([good] * 19 + [bad])[0]
    assert (first.value, first.n, first.reached) == (0.95, 20, True)
    assert first.low == pytest.approx(0.7639, abs=1e-3)
    assert rates([])[0].reached is None
    assert confusion([good, bad]) == {"rack_mass": {"rack_mass": 1, "(nothing)": 1}}


def test_every_effect_of_the_catalogue_can_be_hidden_and_outsiders_cannot_be_named():
    assert {e.name for e in LISTED} == set(EFFECTS)
    assert len(OUTSIDE) >= 6
    assert not {e.name for e in OUTSIDE} & set(EFFECTS)
    for effect in LISTED:
        assert set(effect.equivalent(effect.typical)) <= set(EFFECTS[effect.name].parameters)


def test_a_sample_reaches_every_effect():
    hidden = {job.effect for job in plan(200, 0) if job.kind == "visible"}
    assert hidden == {e.name for e in LISTED}


def test_a_full_run_goes_on_with_more_of_the_kinds_whose_targets_are_small_rates():
    sample, full = plan(200, 7), plan(200, 7, least={"clean": 300, "outside": 60})
    assert set(sample) < set(full)
    more = Counter(job.kind for job in full) - Counter(job.kind for job in sample)
    assert more == {"clean": 270, "outside": 40}


def test_a_clean_case_is_written_read_and_repeated_to_the_byte(tmp_path):
    drawn = draw_case("clean", 3, seconds=2.0)
    again = draw_case("clean", 3, seconds=2.0)
    sealed = drawn.sealed
    for name, case in (("one", drawn), ("two", again)):
        (tmp_path / name).mkdir()
        write_case(
            tmp_path / name / "bag", case.signals, case.nominal, sealed.valve_system, sealed.load
        )
    one, two = (next((tmp_path / n / "bag").glob("*.mcap")).read_bytes() for n in ("one", "two"))
    assert one == two
    read = record_from_bag(tmp_path / "one" / "bag")
    made = record_of(drawn.signals, drawn.nominal, sealed.valve_system, sealed.load, "one")
    assert set(read.channels) == set(made.channels)
    assert all(np.array_equal(read[c], made[c]) for c in made.channels)


def test_nothing_of_the_truth_is_in_the_bag(tmp_path):
    hidden = "pressure_sensor_offset_left"
    drawn = draw_case("visible", 7, hidden, seconds=2.0)
    assert drawn.sealed.hidden == (hidden,)
    assert drawn.sealed.parameters[hidden]["offset"] == drawn.sealed.sizes[hidden]
    bag = tmp_path / "bag"
    write_case(bag, drawn.signals, drawn.nominal, drawn.sealed.valve_system, drawn.sealed.load)
    assert not any(hidden.encode() in file.read_bytes() for file in bag.iterdir())
    trace = read_bag(bag)
    assert not any(topic.startswith("/truth") for topic in trace.topics)
    assert trace.run["effects"] == {}
    assert record_from_bag(bag).nominal.changed() == {}


def test_a_case_is_solved_once_and_its_bag_does_not_tell_its_kind(tmp_path):
    job = Job("clean", 7)
    judgement = solve(job, "baseline", tmp_path)
    assert read_sealed(tmp_path / "sealed" / f"{job.name}.json").hidden == ()
    assert not any("clean" in folder.name for folder in (tmp_path / "cases").iterdir())
    kept = next((tmp_path / "results").rglob("*.json"))
    before = kept.read_bytes()
    assert solve(job, "baseline", tmp_path) == judgement
    assert kept.read_bytes() == before


def test_a_case_that_cannot_be_drawn_is_told_and_counted_nowhere(tmp_path, monkeypatch):
    def prepare(job, folder):
        raise BenchError(f"no record of seed {job.seed} shows it")

    monkeypatch.setattr("steering_diagnosis.benchmark.runner.prepare", prepare)
    judgement = solve(Job("visible", 7), "baseline", tmp_path)
    assert judgement.failure == "no record of seed 7 shows it"
    assert all(rate.n == 0 for rate in rates([judgement]))


def test_a_changed_seal_is_refused(tmp_path):
    file = tmp_path / "sealed.json"
    ONE.write(file)
    assert read_sealed(file) == ONE
    document = json.loads(file.read_text())
    document["truth"]["sizes"]["rack_mass"] = 11.0
    file.write_text(json.dumps(document))
    with pytest.raises(BenchError, match="changed"):
        read_sealed(file)


def test_an_unknown_method_is_refused():
    with pytest.raises(BenchError, match="cannot be loaded"):
        load_function("nowhere:nothing")
    assert load_function("baseline") is baseline


def test_options_of_the_benchmark_are_handed_on_and_nowhere_else():
    from steering_bringup.cli import _parser, bench

    def given(line):
        return bench._of_diagnosis(_parser(["bench"]).parse_args(["bench", *line.split()]))

    assert given("diagnosis --cases 4 --kinds clean pair --full") == [
        "--full",
        "--cases",
        "4",
        "--kinds",
        "clean",
        "pair",
    ]
    assert given("graph_speed") == []
    with pytest.raises(BenchError, match="diagnosis"):
        given("graph_speed --cases 4")
