"""Several specimens: what they have in common, and what one has alone."""

import json

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from steering_bringup.cli import main
from steering_core.errors import BenchError
from steering_diagnosis.fleet.run import found_in
from steering_diagnosis.fleet.shift import shifts
from steering_diagnosis.fleet.telling import extension, lines
from steering_diagnosis.fleet.verdict import judged
from steering_diagnosis.report import Cause, Estimate, Learned, Report, Source

NAMES = ("gear.stiffness", "gear.ratio", "gear.damping", "gear.unseen")


def member(random, mean, information, names=NAMES):
    """Return what a record tells of a specimen drawn about ``mean`` [deviations]."""
    p = len(names)
    z = mean + random.standard_normal(p)
    spread = np.linalg.inv(information + np.eye(p))
    seen = np.linalg.cholesky(information + 1e-12 * np.eye(p))
    # the estimate that the record alone would give, drawn in its own noise, under the prior
    slope = information @ z + seen @ random.standard_normal(p)
    return Learned(
        names=list(names),
        nominal=[10.0] * p,
        deviation=[0.5] * p,
        mean=(spread @ slope).tolist(),
        covariance=spread.tolist(),
    )


def information(random, strength=30.0):
    """Return the information of a record in which two parameters trade and one is not seen."""
    rows = random.standard_normal((3, 4)) @ np.diag([1.0, 1.0, 0.3, 0.0])
    rows[:, 1] += 0.8 * rows[:, 0]
    return strength * rows.T @ rows


def fleet_of(random, count, mean):
    return [member(random, mean, information(random)) for _ in range(count)]


def test_a_common_shift_is_found_with_its_size_and_nothing_else():
    random = np.random.default_rng(3)
    found = {s.name: s for s in shifts(fleet_of(random, 40, np.array([1.5, 0.0, 0.0, 3.0])))}
    assert found["gear.stiffness"].common
    assert found["gear.stiffness"].mean == pytest.approx(1.5, abs=3.0 * found["gear.stiffness"].sd)
    assert found["gear.stiffness"].value == pytest.approx(10.0 + 0.5 * 1.5, abs=0.3)
    assert found["gear.stiffness"].scatter == pytest.approx(1.0, abs=0.3)
    assert not any(s.common for n, s in found.items() if n != "gear.stiffness")
    assert not found["gear.unseen"].judged


def test_the_mean_is_as_certain_as_it_says():
    random = np.random.default_rng(4)
    errors = []
    for _ in range(300):
        found = {s.name: s for s in shifts(fleet_of(random, 8, np.zeros(4)))}
        errors += [found[n].mean / found[n].sd for n in NAMES[:3]]
    assert np.std(errors) == pytest.approx(1.0, abs=0.08)
    assert abs(np.mean(errors)) < 0.1


@settings(max_examples=20, deadline=None)
@given(seed=st.integers(0, 10_000))
def test_a_fleet_within_its_tolerances_has_nothing_in_common(seed):
    random = np.random.default_rng(seed)
    found = shifts(fleet_of(random, 12, np.zeros(4)))
    # one false alarm in a hundred fleets is allowed; five deviations are none of it
    assert all(abs(s.mean) < 5.0 * s.sd for s in found)


def report(causes=(), learned=None, undecidable=(), verdict="clean"):
    return Report(
        schema=1,
        bag=Source(path="x", sha256="0"),
        software="1",
        verdict="named" if causes else verdict,
        sentence="",
        causes=[
            Cause(
                effect=name,
                balance="b",
                parameters={"factor": Estimate(value=v, low=v - 1.0, high=v + 1.0, unit="")},
                p_value=0.0,
                delta_bic=-100.0,
                gain={},
            )
            for name, v in dict(causes).items()
        ],
        undecidable=dict.fromkeys(undecidable, "too small"),
        learned=learned,
    )


def test_causes_of_all_are_common_and_those_of_one_are_its_own():
    reports = {f"car{k}": report({"bar": 1.1 + 0.01 * k}) for k in range(4)}
    reports["car4"] = report({"bar": 1.1, "leak": 2.0})
    reports["car5"] = report(undecidable=["bar"])
    reports["car6"] = report(verdict="unexplained")
    fleet = judged(reports)
    assert set(fleet.common) == {"bar"}
    assert len(fleet.common["bar"]) == 5
    assert fleet.single == {"car4": ("leak",)}
    assert fleet.unexplained == ("car6",)
    sizes = extension(fleet, reports)["effects"]["bar"]
    assert sizes["factor"] == pytest.approx(np.mean([1.10, 1.11, 1.12, 1.13, 1.10]))
    text = "\n".join(lines(fleet, {"car7": "no such file"}))
    assert "common: bar, named in 5 of 7" in text
    assert "single: car4: leak" in text
    assert "not judged: car7: no such file" in text


def test_what_one_specimen_s_own_cause_changes_tells_nothing_of_the_others():
    random = np.random.default_rng(5)
    members = [member(random, np.zeros(4), 100.0 * np.eye(4)) for _ in range(6)]
    broken = members[0].model_copy(
        update={"mean": [40.0, *members[0].mean[1:]], "changed_by": {"gear.stiffness": ["worn"]}}
    )
    causes = [{"worn": 2.0}, *({} for _ in members[1:])]
    reports = {
        f"car{k}": report(c, x)
        for k, (c, x) in enumerate(zip(causes, [broken, *members[1:]], strict=True))
    }
    fleet = judged(reports)
    assert fleet.single == {"car0": ("worn",)}
    assert not fleet.shifted


def test_records_are_found_in_folders_and_names_are_unique(tmp_path):
    (tmp_path / "a").mkdir()
    for name in ("two.csv", "one.mf4", "notes.md"):
        (tmp_path / "a" / name).touch()
    assert list(found_in([tmp_path / "a"])) == ["one", "two"]
    (tmp_path / "two.mat").touch()
    with pytest.raises(BenchError, match="two records are called 'two'"):
        found_in([tmp_path / "a", tmp_path / "two.mat"])
    with pytest.raises(BenchError, match="there is no"):
        found_in([tmp_path / "b"])
    (tmp_path / "empty").mkdir()
    with pytest.raises(BenchError, match="no bag and no measured file"):
        found_in([tmp_path / "empty"])


def test_the_command_judges_two_bags_and_goes_on_where_it_stopped(tmp_path, capsys):
    common = ["run", "on_centre", "--direct", "--duration", "5", "--node-set", "open_centre"]
    for name, hidden in (("one", 60.9), ("two", 60.5)):
        value = f"mechanics.torsion_bar_stiffness={hidden}"
        assert main([*common, "--out", str(tmp_path / name), "--set", value]) == 0
        (tmp_path / name / "open_centre").rename(tmp_path / f"{name}_bag")
    bags = [str(tmp_path / f"{name}_bag") for name in ("one", "two")]
    call = ["fleet", *bags, "--out", str(tmp_path / "fleet"), "--jobs", "1"]
    capsys.readouterr()
    assert main(call) == 0
    told = capsys.readouterr().out
    assert "2 specimens judged" in told
    assert "single:" not in told
    written = json.loads((tmp_path / "fleet" / "fleet.json").read_text())
    assert written["members"] == ["one_bag", "two_bag"]
    first = (tmp_path / "fleet" / "one_bag" / "report.json").stat().st_mtime_ns
    assert main(["fleet", str(tmp_path / "three.csv"), *call[1:]]) == 1  # it is not there
    assert "there is no" in capsys.readouterr().err
    assert main(call) == 0
    assert (tmp_path / "fleet" / "one_bag" / "report.json").stat().st_mtime_ns == first
