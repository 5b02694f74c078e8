import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from steering_core.csv_columns import CsvError, read_columns
from steering_core.ticks import TICK_PERIOD, tick_times

COLUMNS = ("time_s", "rack_force_N")


def written(tmp_path, text: str):
    path = tmp_path / "numbers.csv"
    path.write_bytes(text.encode())
    return path


def test_reads_around_comments_blank_lines_spaces_and_a_byte_order_mark(tmp_path):
    text = (
        "\ufeff# made on the rig\r\ntime_s , rack_force_N\r\n\r\n0, 1e3\r\n# half way\r\n1,-2\r\n"
    )
    table = read_columns(written(tmp_path, text), COLUMNS, increasing="time_s")
    assert list(table) == list(COLUMNS)
    assert table["rack_force_N"].tolist() == [1000.0, -2.0]
    assert table["time_s"].dtype == np.float64
    assert table["time_s"].flags["C_CONTIGUOUS"]


FAULTS = [
    ("", "numbers.csv: the file is empty"),
    ("time_s,rack_force_N\n", "there are no numbers below the header"),
    ("time_s\n0\n", "line 1: column 'rack_force_N' is missing"),
    ("time_s,time_s,rack_force_N\n0,0,0\n", "line 1: column 'time_s' is named twice"),
    ("time_s,rack_force\n0,0\n", "unknown column 'rack_force'; did you mean 'rack_force_N'"),
    ("time_s,q\n0,0\n", "unknown column 'q'; expected time_s, rack_force_N"),
    ("time_s,rack_force_N\n0,1\n\n1\n", "line 4: 1 values for 2 columns"),
    ("time_s,rack_force_N\n0,1 kN\n", "line 2: rack_force_N '1 kN' is not a number"),
    ("time_s,rack_force_N\n0,\n", "line 2: rack_force_N '' is not a number"),
    ("time_s,rack_force_N\n0,inf\n", "line 2: rack_force_N must be finite, got inf"),
    ("time_s,rack_force_N\n1,0\n2,0\n1.5,0\n", "line 4: time_s must increase, got 1.5 after 2"),
]


@pytest.mark.parametrize(("text", "message"), FAULTS)
def test_faults_are_named(tmp_path, text, message):
    with pytest.raises(CsvError, match=message):
        read_columns(written(tmp_path, text), COLUMNS, increasing="time_s")


def test_what_is_no_text_file_is_named(tmp_path):
    with pytest.raises(CsvError, match="no such file"):
        read_columns(tmp_path / "absent.csv", COLUMNS)
    with pytest.raises(CsvError, match="cannot be read"):
        read_columns(tmp_path, COLUMNS)
    (tmp_path / "noise.csv").write_bytes(b"\xff\xfe\x00\x9f")
    with pytest.raises(CsvError, match="cannot be read"):
        read_columns(tmp_path / "noise.csv", COLUMNS)


@settings(max_examples=50, deadline=None)
@given(values=st.lists(st.floats(allow_nan=False, allow_infinity=False), min_size=1, max_size=20))
def test_numbers_come_back_to_the_bit(values, tmp_path_factory):
    path = tmp_path_factory.mktemp("csv") / "numbers.csv"
    path.write_text("value\n" + "".join(f"{value!r}\n" for value in values), encoding="utf-8")
    assert read_columns(path, ("value",))["value"].tolist() == values


def test_tick_times_are_the_nearest_doubles():
    times = tick_times(5001)
    assert times[3] == 0.003
    assert times[4999] == 4.999
    assert times[-1] == 5.0
    assert TICK_PERIOD == 0.001
