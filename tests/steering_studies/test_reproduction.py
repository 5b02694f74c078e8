"""Verdicts of the reproduction follow from the numbers and the tolerances of the targets."""

import pytest

from steering_bringup.cli import main
from steering_bringup.errors import BenchError
from steering_studies.pages.reproduce import reproduction_page
from steering_studies.reproduce.all_rows import ROWS, make
from steering_studies.reproduce.row import Number, Row


@pytest.mark.parametrize(
    ("number", "good"),
    [
        (Number("stiffness", "N m/deg", 1.06, 1.069, "input"), True),
        (Number("stiffness", "N m/deg", 1.06, 1.08, "input"), False),
        (Number("rise", "ms", 8.5, 9.3, "time"), True),
        (Number("rise", "ms", 8.5, 9.4, "time"), False),
        (Number("error", "bar", 1.0, 1.4, "pressure", "at most"), True),
        (Number("error", "bar", 1.0, 1.6, "pressure", "at most"), False),
        (Number("difference", "N m", 0.1, 0.14, "torque"), True),
        (Number("force", "N", 82.0, 101.0, "force"), True),
        (Number("opening", "mm2", 0.5, 0.6, "other", "at least"), True),
        (Number("shape", "bar", None, 3.0), None),
    ],
)
def test_a_number_is_judged_by_its_kind(number, good):
    assert number.good is good


def test_a_row_s_verdict_is_its_worst_number_s():
    met, missed = Number("a", "s", 1.0, 1.0), Number("b", "s", 1.0, 2.0)
    silent = Number("c", "s", None, 2.0)
    assert Row("1", "", [met, silent]).verdict == "reproduced"
    assert Row("1", "", [met, missed]).verdict == "differs"
    assert Row("1", "", [silent]).verdict == "shape only"
    text = Row("1", "", [met, missed], because="it is so").sentence()
    assert text == "Differs in b, because it is so."


def test_a_row_is_made_shown_and_told(tmp_path, capsys):
    assert main(["reproduce", "rig.stiffness_of_the_column", "--jobs", "1", "--out",
                 str(tmp_path)]) == 0  # fmt: skip
    assert "fig 3.8          reproduced" in capsys.readouterr().out
    assert "1.06" in (tmp_path / "reproduction.html").read_text("utf-8")


def test_every_row_can_be_listed_and_a_wrong_name_is_told(capsys):
    assert main(["reproduce", "--list"]) == 0
    listed = capsys.readouterr().out
    assert all(name in listed for name in ROWS)
    with pytest.raises(BenchError, match=r"did you mean 'rig\.boost_curve'"):
        make(["rig.boost_curv"])
    assert "differ" in reproduction_page([Row("1", "x", [Number("b", "s", 1.0, 2.0)])]).render()
