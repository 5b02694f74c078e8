"""What differs between the results of two trees over the same sealed cases."""

import json

import pytest
from written_reports import ONE, cause, report

from steering_core.errors import BenchError
from steering_diagnosis.benchmark.changes import changes
from steering_diagnosis.benchmark.scoring import judge

RIGHT = cause("rack_mass", added={"value": 10.0, "low": 9.0, "high": 11.0})


@pytest.fixture
def records(tmp_path):
    """Write a folder of records with the results of one case; its name leads to its report."""

    def write(name, **reports):
        folder = tmp_path / name
        for case, told in reports.items():
            kept = folder / "results" / "engine" / f"{case}.json"
            kept.parent.mkdir(parents=True, exist_ok=True)
            judgement = {**judge(told, ONE).as_json(), "case": case}
            kept.write_text(json.dumps({"judgement": judgement, "report": told}))
        return folder

    return write


def test_names_sizes_and_what_became_wrong_are_told(records):
    heavier = cause("rack_mass", added={"value": 11.0, "low": 9.0, "high": 12.0})
    nothing = report(verdict="clean")
    before = records("a", same=report(RIGHT), size=report(RIGHT), lost=report(RIGHT), won=nothing)
    after = records("b", same=report(RIGHT), size=report(heavier), lost=nothing, won=report(RIGHT))
    counts = "verdicts or names: 2, sizes: 1, became right: 1, became wrong: 1"
    assert list(changes(before, after, "engine")) == [
        ("lost", "named: rack_mass -> clean (now wrong)"),
        ("size", "rack_mass.added: 10 -> 11"),
        ("won", "clean -> named: rack_mass (now right)"),
        ("4 cases", f"{counts}; 0 in one of the two only"),
    ]


def test_the_last_digits_are_no_change(records):
    other = cause("rack_mass", added={"value": 10.0001, "low": 9.0, "high": 11.0})
    told = list(changes(records("a", one=report(RIGHT)), records("b", one=report(other)), "engine"))
    assert len(told) == 1


def test_folders_without_common_cases_are_refused(records, tmp_path):
    one, two = records("a", one=report(RIGHT)), records("b", two=report(RIGHT))
    with pytest.raises(BenchError, match="no case in common"):
        list(changes(one, two, "engine"))
    with pytest.raises(BenchError, match="holds no results of 'engine'"):
        list(changes(tmp_path, two, "engine"))
