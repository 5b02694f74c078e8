"""Verdicts of the reproduction follow from the numbers and the tolerances of the targets."""

import numpy as np
import pytest

from pressure_control.linear_servo import servo_assistance
from steering_bringup.cli import main
from steering_bringup.errors import BenchError
from steering_core.parameters import load_parameters
from steering_plant.linear.gear import linear_gear
from steering_studies.linear.bode import family
from steering_studies.linear.source_figures import servo_as_printed
from steering_studies.pages.reproduce import reproduction_page
from steering_studies.reproduce.all_rows import ROWS, make
from steering_studies.reproduce.row import Number, Row
from steering_studies.reproduce.steering_loop import stable_up_to


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


def test_the_rows_of_chapter_8_and_the_boost_curve_meet_the_source():
    names = ("results.dry_park", "results.step", "results.assistance", "results.torque_difference",
             "open_centre.heavy_vehicle_boost_curve", "open_centre.pressure_response",
             "energy.energy")  # fmt: skip
    rows = make(names)
    assert [row.verdict for row in rows] == ["reproduced"] * len(names)
    assert [row.figure for row in rows] == ["2.3", "4.5", "8.1", "8.2", "8.4", "8.6", "energy"]


def test_a_bode_plot_has_the_source_s_axes_and_room_for_ours():
    row = ROWS["open_centre.closed_loop"]()
    amplitude, phase = (line[0] for line in row.figures[0].rows)
    assert amplitude.log_x
    assert amplitude.limits == (-20.0, 0.0)
    assert amplitude.y_range is not None
    assert amplitude.y_range[1] > max(curve.y.max() for curve in amplitude.curves) > 0.0
    assert max(curve.x.max() for curve in phase.curves) <= 20.0


def test_the_servo_valves_loop_is_stable_for_on_centre_torques_only():
    """The eigenvalues' answer against the drawn loop gain, which passes -1 at 3.5 N m."""
    parameters = servo_as_printed(load_parameters())
    assert 3.0 <= stable_up_to(parameters) < 3.5
    found = family(
        "7.6",
        "",
        lambda t, w: linear_gear(parameters).loop_gain(servo_assistance(parameters, t, w)),
        torques=(3.0, 3.5),
        frequency=np.logspace(1.5, 2.3, 400),
    )
    crossing = [
        float(np.interp(-180.0, degrees[::-1], np.abs(loop)[::-1]))
        for degrees, loop in zip(found.degrees, found.response, strict=True)
    ]
    assert crossing[0] < 1.0 < crossing[1]
