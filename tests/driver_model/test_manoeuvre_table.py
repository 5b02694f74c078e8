import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from driver_model.manoeuvres import ManoeuvreError, load_table, make_manoeuvre

HEADER = "time_s,steering_wheel_angle_deg\n"


def written(tmp_path, text: str):
    path = tmp_path / "manoeuvre.csv"
    path.write_text(text, encoding="utf-8")
    return path


def test_reads_interpolates_and_holds_the_ends(tmp_path):
    table = load_table(written(tmp_path, HEADER + "0.5, 10\n1.5, 30\n2.5, -30\n"))
    angles = np.degrees(table.angle(np.array([0.0, 0.5, 1.0, 2.0, 9.0])))
    assert angles == pytest.approx([10.0, 10.0, 20.0, 0.0, -30.0])
    assert make_manoeuvre("table", file=tmp_path / "manoeuvre.csv") == table


def test_columns_may_come_in_any_order(tmp_path):
    table = load_table(written(tmp_path, "steering_wheel_angle_deg,time_s\n7,1\n8,2\n"))
    assert table.time_s == (1.0, 2.0)
    assert table.steering_wheel_angle_deg == (7.0, 8.0)


FAULTS = [
    (HEADER + "0,1\n1,nan\n", "line 3: steering_wheel_angle_deg must be finite, got nan"),
    (HEADER + "0,1\n0,2\n", "line 3: time_s must increase, got 0 after 0"),
    ("time_s,angle\n0,1\n", "line 1: unknown column 'angle'"),
    (HEADER + "0,5000\n", "manoeuvre.csv: table: an angle is beyond 1080 deg"),
]


@pytest.mark.parametrize(("text", "message"), FAULTS)
def test_faults_are_named_with_their_line(tmp_path, text, message):
    with pytest.raises(ManoeuvreError, match=message):
        load_table(written(tmp_path, text))


def test_missing_file_is_named(tmp_path):
    with pytest.raises(ManoeuvreError, match=r"absent\.csv: there is no such file"):
        load_table(tmp_path / "absent.csv")


WRONG = [
    ({"time_s": (0.0, 1.0), "steering_wheel_angle_deg": (0.0,)}, "2 times for 1 angles"),
    ({"time_s": (), "steering_wheel_angle_deg": ()}, "0 times for 0 angles"),
    ({"time_s": (0.0, float("inf")), "steering_wheel_angle_deg": (0.0, 1.0)}, "must be finite"),
    ({"time_s": (0.0, 1.0, 1.0), "steering_wheel_angle_deg": (0.0,) * 3}, "entry 2 does not"),
    ({"file": "a.csv", "time_s": (0.0,)}, "either a file or times and angles"),
]


@pytest.mark.parametrize(("values", "message"), WRONG)
def test_wrong_values_are_named(values, message):
    with pytest.raises(ManoeuvreError, match=message):
        make_manoeuvre("table", **values)


@settings(max_examples=50, deadline=None)
@given(st.lists(st.floats(-1000.0, 1000.0), min_size=1, max_size=30))
def test_passes_through_every_point(angles):
    times = tuple(float(k) for k in range(len(angles)))
    table = make_manoeuvre("table", time_s=times, steering_wheel_angle_deg=tuple(angles))
    assert table.angle(np.array(times)) == pytest.approx(np.radians(angles))
