"""CSV as people have it: each kind of table is read right, or refused by a line that names it."""

import gzip
import math
from datetime import datetime, timedelta
from decimal import Decimal
from pathlib import Path

import numpy as np
import pytest

from steering_core.errors import BenchError
from steering_diagnosis.data.foreign import Raw, read_foreign
from steering_diagnosis.data.mapping import Mapping
from steering_diagnosis.data.read import read_record

N = 12
TIME = [k / 1000 for k in range(N)]
P = [5.5 + k / 4 for k in range(N)]


def mapped(**keys) -> Mapping:
    channels = keys.pop("channels", {"left_pressure": {"from": "p", "unit": "bar"}})
    return Mapping.model_validate(
        {"valve_system": "open_centre", "time": "t", "channels": channels, **keys}
    )


def read(folder: Path, data: str | bytes, **keys) -> Raw:
    path = folder / "drive.csv"
    path.write_bytes(data if isinstance(data, bytes) else data.encode())
    return read_foreign(path, mapped(**keys))["left_pressure"]


def table(separator=",", decimal=".", head="t,p", time=None, values=None, end=""):
    rows = zip(time or [f"{t:.3f}" for t in TIME], values or map(str, P), strict=True)
    lines = [head.replace(",", separator)]
    lines += [f"{t}{separator}{p}".replace(".", decimal) + end for t, p in rows]
    return "\n".join(lines) + "\n"


def is_right(raw: Raw) -> None:
    np.testing.assert_array_equal(raw.values, P)
    np.testing.assert_allclose(clock(raw), np.array(TIME), rtol=0, atol=1e-12)


def clock(raw: Raw) -> np.ndarray:
    assert raw.time is not None
    return raw.time


@pytest.mark.parametrize(
    "data",
    [
        table(),
        table(";", ","),
        table("\t", ","),
        table("|"),
        table(" ", ","),
        table().replace(",", "   "),
        table().replace(",", ", "),
        "sep=;\n" + table(";", ","),
        '"sep=\t"\n' + table("\t", ","),
        "\ufeff" + table(),
        table().replace("\n", "\r\n"),
        table().replace("\n", "\r"),
        table().replace("\n", "\r\r\n"),
        table() + "\x1a",
        table() + "\x00" * 512,
        "\n\n" + table(),
        "Messung;Prüfstand 3\nBediener;NN\n\n" + table(";", ","),
        "t: time, p: pressure\n1,2\n\n" + table(),
        "Kanäle:;t;p\n" + table(";", ","),
        "# " + table(),
        "# " + table(" "),
        "% " + table("\t"),
        "#t,p\n# a comment, 2\n" + table().partition("\n")[2],
        table().replace("\n", "\n# 1,2,3\n// 4,5\n% 6\n"),
        table().replace("\n0.005", "\n\n   \n0.005"),
        table().replace("\n0.011", "\nt,p\n0.011").replace("t,p\n0.000", "t,p\ns,bar\n0.000"),
        table(end=",") + ",,\n,,\n,,\n",
        table(";", ",", end=";;"),
        table(head="t,p,").replace("\n0", "\n0"),
        table(head='"t","p"'),
        table(head='"t","p\n[bar]"'),
        table(head='t [s],"p [bar]"'),
        table(head="t (s),p (bar)"),
        table(head="\u00a0t , p "),
        table(head="t,p\ns,bar"),
        "LabVIEW Measurement\t\nWriter_Version\t2\n***End_of_Header***\t\n\t\n"
        + table("\t", head="t,p,Comment"),
        table(head="t,p\n-,-\nID7,ID8"),
        ",t,p\n" + "".join(f"{k},{t},{p}\n" for k, (t, p) in enumerate(zip(TIME, P, strict=True))),
        "#;t;p\n" + "".join(f"{k};{t};{p}\n" for k, (t, p) in enumerate(zip(TIME, P, strict=True))),
        'note,t,p\n"a, ""b""\nc",'
        + '"x,\ny",'.join(f"{t},{p}\n" for t, p in zip(TIME, P, strict=True)),
        table(values=[f'"{p}"'.replace(".", ",") for p in P]),
        table(values=[f"+{p:.7E}" for p in P]),
        table(";", ",", values=[f"{p:.7e}".replace("e", "D") for p in P]),
    ],
)
def test_a_dialect_is_found(tmp_path, data):
    raw = read(tmp_path, data)
    is_right(raw)
    assert raw.lost == ""


@pytest.mark.parametrize(
    "encoding",
    ["cp1252", "cp850", "mac-roman", "utf-8", "utf-8-sig", "utf-16", "utf-16-le", "utf-16-be"],
)
@pytest.mark.parametrize("name", ["Lenkwinkel [°]", "Öldruck", "Winkel für p"])
def test_an_encoding_is_found_by_the_mapped_names(tmp_path, encoding, name):
    data = table(";", ",", head=f"t,{name}").encode(encoding)
    is_right(read(tmp_path, data, channels={"left_pressure": {"from": name, "unit": "bar"}}))


def test_names_in_japanese_and_a_given_encoding(tmp_path):
    channels = {"left_pressure": {"from": "左圧力", "unit": "bar"}}
    data = table(head="t,左圧力").encode("shift_jis")
    is_right(read(tmp_path, data, channels=channels))
    is_right(read(tmp_path, data, channels=channels, encoding="shift_jis"))
    with pytest.raises(BenchError, match=r"line 1: no utf-8 .*`encoding`"):
        read(tmp_path, data, channels=channels, encoding="utf-8")


def test_a_packed_file(tmp_path):
    path = tmp_path / "drive.csv.gz"
    path.write_bytes(gzip.compress(table().encode()))
    is_right(read_foreign(path, mapped())["left_pressure"])
    path.write_bytes(path.read_bytes()[:-20])
    with pytest.raises(BenchError, match="cannot be read"):
        read_foreign(path, mapped())


@pytest.mark.parametrize(
    ("cells", "values"),
    [
        (["1.234,5", "-2.000", "999"], [1234.5, -2000.0, 999.0]),
        (["1,234.5", "-2,000", "999"], [1234.5, -2000.0, 999.0]),
        (["1'234.5", "-2’000", "999"], [1234.5, -2000.0, 999.0]),
        (["1 234,5", "−2\u202f000", "999"], [1234.5, -2000.0, 999.0]),
        (["1.234.567", "2.000", "-5"], [1234567.0, 2000.0, -5.0]),
        (["1,234", "0,5", "2000,125"], [1.234, 0.5, 2000.125]),
        (["1.234", "-.5", "5."], [1.234, -0.5, 5.0]),
        (["1,5E-3", "-2e3", "1D2"], [1.5e-3, -2e3, 100.0]),
    ],
)
def test_numbers_of_all_countries(tmp_path, cells, values):
    raw = read(tmp_path, "n;t;p\n" + "".join(f"1;{k};{c}\n" for k, c in enumerate(cells)))
    np.testing.assert_array_equal(raw.values, values)


def test_whole_numbers_first_and_the_other_columns_decide(tmp_path):
    rows = "".join(f"{k / 1000:.3f};{14 + k}.420;\n".replace(".", ",") for k in range(N))
    raw = read(tmp_path, "t;p\n" + rows)
    np.testing.assert_allclose(raw.values, 14.42 + np.arange(N))


@pytest.mark.parametrize(
    ("cells", "words", "keys", "values"),
    [
        (["1,234", "5,678"], ("line 2", "'1,234'", "decimal"), {"decimal": ","}, [1.234, 5.678]),
        (["1,234", "5,678"], ("`decimal`",), {"thousands": ","}, [1234.0, 5678.0]),
        (["1.234", "5.678"], ("line 2", "'1.234'", "`decimal`"), {"decimal": "."}, [1.234, 5.678]),
        (["1,5", "2.5"], ("line 2", "line 3", "`decimal`"), {"decimal": ","}, None),
        (["0,5", "1.234"], ("line 3", "'1.234'", "`thousands`"), {"thousands": "."}, [0.5, 1234.0]),
    ],
)
def test_two_readings_are_asked_for(tmp_path, cells, words, keys, values):
    data = "t;p\n" + "".join(f"{k};{cell}\n" for k, cell in enumerate(cells))
    with pytest.raises(BenchError) as caught:
        read(tmp_path, data)
    for word in words:
        assert word in str(caught.value)
    if values is not None:
        np.testing.assert_array_equal(read(tmp_path, data, **keys).values, values)


def test_a_point_between_commas_is_no_proof(tmp_path):
    data = 't,p\n1,"4.293"\n2,"1.250"\n'
    with pytest.raises(BenchError, match=r"line 2: '4\.293' of 'p'.*`decimal`"):
        read(tmp_path, data)
    np.testing.assert_array_equal(read(tmp_path, data, decimal=".").values, [4.293, 1.25])


def test_decimal_commas_between_commas_are_never_taken_for_separators(tmp_path):
    for head, end in (("t,p", ""), ("t,p", ","), ("t,p,note", ","), ("t,p,note", ",x")):
        rows = "".join(f"{k / 1000:.3f},{k}{end}\n".replace(".", ",") for k in range(N))
        with pytest.raises(
            BenchError, match=r"the decimal sign the separator too|commas may be decimal"
        ):
            read(tmp_path, head + "\n" + rows)


@pytest.mark.parametrize(
    "word",
    [
        *("NaN", "n/a", "#N/A", "#NV", "-", "--", "null", "None", "inf", "-1.#IND", "1.#QNAN"),
        *("Overflow", "SNA", "#DIV/0!"),
        "",
        "abc",
    ],
)
def test_a_lost_cell_is_one_gap_and_told(tmp_path, word):
    values = [*map(str, P[:4]), word, *map(str, P[5:])]
    raw = read(tmp_path, table(values=values))
    assert np.flatnonzero(np.isnan(raw.values)).tolist() == [4]
    assert raw.lost == (f"'{word}' first in line 6" if word else "an empty cell first in line 6")


def test_a_lost_cell_that_begins_a_row_is_no_comment(tmp_path):
    data = "p;t\n" + "".join(f"{'#NV' if k == 3 else p};{k}\n" for k, p in enumerate(P))
    raw = read(tmp_path, data)
    assert len(raw.values) == N
    assert np.flatnonzero(np.isnan(raw.values)).tolist() == [3]


def test_given_words_and_numbers_stand_for_nothing(tmp_path):
    data = table(values=["-999.000", "kaputt", *map(str, P[2:])])
    raw = read(tmp_path, data, missing=[-999, "kaputt"])
    assert np.flatnonzero(np.isnan(raw.values)).tolist() == [0, 1]


def test_much_text_is_an_error(tmp_path):
    with pytest.raises(BenchError, match=r"line 4: p 'x' is not a number, nor are 1 more of 12"):
        read(tmp_path, table(values=["1", "2", "x", *"4567", "x", *"8901"]))
    with pytest.raises(BenchError, match="line 2: p 'on' is not a number"):
        read(tmp_path, table(values=["on"] * N))


def test_rows_of_other_lengths_tell_nothing_and_are_counted(tmp_path):
    lines = table(end=",1").replace("t,p,1", "t,p,q").splitlines()
    lines[0] = "t,p,q"
    rows = [*lines[1:], *(line.replace("0.0", "0.1") for line in lines[1:])]
    rows[3], rows[9] = "0.003,8,8,8", "0.009,9"
    raw = read(tmp_path, "\n".join([lines[0], *rows]) + "\n")
    assert np.flatnonzero(np.isnan(raw.values)).tolist() == [3, 9]
    assert "2 of 24 rows have more or fewer cells" in raw.about[0]
    assert "line 5" in raw.about[0]
    with pytest.raises(BenchError, match=r"rows have more or fewer cells.*line 5"):
        read(tmp_path, "\n".join([lines[0], *rows[:12]]) + "\n")


def test_a_file_that_was_cut_off(tmp_path):
    raw = read(tmp_path, table().removesuffix("25\n"))
    assert math.isnan(raw.values[-1])
    assert "may be cut off" in raw.about[0]
    raw = read(tmp_path, table()[:-7])
    assert math.isnan(raw.values[-1])
    assert "1 of 12 rows" in raw.about[0]


def test_a_quote_without_an_end_swallows_nothing(tmp_path):
    data = table(end=",ok").replace("t,p,ok", "t,p,note").replace("0.004,6.5,ok", '0.004,6.5,"ok')
    with pytest.raises(BenchError, match=r"line 6: .*quote"):
        read(tmp_path, "t,p,note\n" + data.partition("\n")[2])


@pytest.mark.parametrize(
    ("data", "words"),
    [
        ("", "is empty"),
        ("\x00" * 100, "empty but for zero bytes"),
        ("t,p\n", "no numbers below the header in line 1"),
        ("t,p\ns,bar\n", "no numbers below"),
        ("0.0,1\n0.1,2\n", "no line of it has names"),
        (table(head="t,P"), "line 1: unknown column 'p'; did you mean 'P'"),
        (
            table(head="t,p [bar],p [psi]").replace("\n0", "\n0,0"),
            "occurs 2 times, in columns 2, 3",
        ),
        (table(head="t,p (bar),p (out)").replace("\n0", "\n0,0"), "occurs 2 times"),
        (table(head="t,p (out)"), "unknown column 'p'"),
        (table(head="t,p , p").replace("\n0", "\n0,0"), "occurs 2 times"),
        (table().replace("\n0.003", "\np,t\n0.003"), "lines 1 and 5 may both be the header"),
        (table().replace("\n0.003", "\nt,p\n0.003"), "stands in line 5 again, after 3 rows"),
        ("Kanäle:,t,p\n" + table().replace("5\n", "5,0\n"), "lines 1 and 2 may both be the header"),
        ("a;p;t\n" + table(";").replace("\n", ";5\n"), "`header_line`"),
        (b"PK\x03\x04" + bytes(range(256)), "Excel workbook"),
        (b"\x93NUMPY" + bytes(range(256)) * 9, "no text"),
        (b"MDF     4.10" + bytes(60), "MDF file"),
        ("<!DOCTYPE html>\n" + table(), "web page"),
    ],
)
def test_what_cannot_be_read_is_named(tmp_path, data, words):
    with pytest.raises(BenchError) as caught:
        read(tmp_path, data)
    assert words in str(caught.value)
    assert "drive.csv" in str(caught.value)


def test_a_folder_named_as_a_file(tmp_path):
    (tmp_path / "drive.csv").mkdir()
    with pytest.raises(BenchError, match="is a folder"):
        read_foreign(tmp_path / "drive.csv", mapped())


def test_a_name_that_occurs_twice_is_chosen_by_its_column(tmp_path):
    rows = "".join(f"{t},{k},{p}\n" for k, (t, p) in enumerate(zip(TIME, P, strict=True)))
    channels = {"left_pressure": {"from": "p", "unit": "bar", "column": 3}}
    is_right(read(tmp_path, "t,p,p\n" + rows, channels=channels))
    channels["left_pressure"]["column"] = 1
    with pytest.raises(BenchError, match="'p' is not in column 1 but in 2, 3"):
        read(tmp_path, "t,p,p\n" + rows, channels=channels)


def test_a_header_and_units_that_the_mapping_gives(tmp_path):
    ranges = "t,p\nmin,0\nmax,9\n"
    data = ranges + "bar units,bar\n" + table(head="t,p") + ""
    with pytest.raises(BenchError, match="`header_line`"):
        read(tmp_path, data)
    raw = read(tmp_path, data, header_line=5, units_line=4)
    is_right(raw)
    assert raw.unit == "bar"


@pytest.mark.parametrize(
    ("head", "unit"),
    [("t,p [bar]", "bar"), ("t,p (psi)", "psi"), ("t,p\ns,[kPa]", "kPa"), ("t,p\n-,-", "")],
)
def test_the_unit_of_the_file_is_found(tmp_path, head, unit):
    assert read(tmp_path, table(head=head)).unit == unit


def test_a_comment_sign_that_the_mapping_gives(tmp_path):
    is_right(read(tmp_path, table().replace("\n0.003", "\n!x,1\n0.003"), comment="!"))


START = datetime(2024, 5, 3, 23, 59, 59, 995000)


@pytest.mark.parametrize(
    ("pattern", "keys"),
    [
        ("%Y-%m-%d %H:%M:%S.%f", {}),
        ("%Y-%m-%dT%H:%M:%S,%fZ", {}),
        ("%Y-%m-%d %H:%M:%S.%f+02:00", {}),
        ("%d.%m.%Y %H:%M:%S,%f", {}),
        ("%d.%m.%y %H:%M:%S.%f", {}),
        ("%d-%b-%Y %H:%M:%S.%f", {}),
        ("%H:%M:%S.%f", {}),
        ("%I:%M:%S.%f %p", {}),
        ("%M:%S.%f", {}),
        ("%d/%m/%Y %H:%M:%S.%f", {"time_format": "%d/%m/%Y %H:%M:%S.%f"}),
        ("%j:%H:%M:%S.%f", {"time_format": "%j:%H:%M:%S.%f"}),
        ("%Y%m%d%H%M%S.%f", {"time_format": "%Y%m%d%H%M%S.%f"}),
        ("%H-%M-%S.%f", {"time_format": "%H-%M-%S.%f"}),
    ],
)
def test_dates_and_times_of_day_across_midnight(tmp_path, pattern, keys):
    cells = [(START + timedelta(milliseconds=k)).strftime(pattern) for k in range(N)]
    is_right(read(tmp_path, table(";", time=cells), **keys))
    in_ms = read(tmp_path, table(";", time=cells), time_unit="ms", **keys)
    np.testing.assert_allclose(clock(in_ms), np.arange(N), atol=1e-9)


def test_day_and_month_are_asked_for_where_they_matter(tmp_path):
    def cells(day: int, hour: int) -> list[str]:
        start = datetime(2024, 3, day, hour, 59, 59, 995000)
        stamps = [start + timedelta(milliseconds=k) for k in range(N)]
        return [stamp.strftime("%m/%d/%Y %H:%M:%S.%f") for stamp in stamps]

    is_right(read(tmp_path, table(time=cells(5, 10))))
    is_right(read(tmp_path, table(time=cells(13, 23))))
    with pytest.raises(BenchError, match=r"line 2, 't': .*'03/05/2024'.*`time_format`"):
        read(tmp_path, table(time=cells(5, 23)))
    with pytest.raises(BenchError, match="'10:00' may be hours and minutes"):
        read(tmp_path, table(time=[f"10:{k:02d}" for k in range(N)]))


@pytest.mark.parametrize(
    ("cells", "unit"),
    [
        ([str(1714728000000000001 + k * 1000000) for k in range(N)], "ns"),
        ([str(k * 1000) for k in range(N)], "us"),
        ([f"1714728000.{k:03d}000001" for k in range(N)], "s"),
        ([f"{k / 60000:.12f}" for k in range(N)], "min"),
        ([f"{k / 3600000:.15f}" for k in range(N)], "h"),
        ([f"{45415 + Decimal(k) / 86400000:.16f}" for k in range(N)], "d"),
    ],
)
def test_units_of_time_and_stamps_with_more_digits_than_a_float(tmp_path, cells, unit):
    raw = read(tmp_path, table(time=cells), time_unit=unit)
    factor = {"ns": 1e-9, "us": 1e-6, "s": 1.0, "min": 60.0, "h": 3600.0, "d": 86400.0}[unit]
    np.testing.assert_allclose(clock(raw) * factor, TIME, atol=2e-9)


def test_milliseconds_without_zeros_before_them_are_refused(tmp_path):
    cells = [f"10:00:00.{5 * k}" for k in range(N)]
    with pytest.raises(BenchError, match=r"'10:00:00\.10' has fewer digits"):
        read(tmp_path, table(time=[*cells, "10:00:00.100"], values=[*map(str, P), "1"]))
    trimmed = [f"10:00:00.{k:03d}".rstrip("0").rstrip(".") for k in range(N)]
    is_right(read(tmp_path, table(time=trimmed)))


def test_a_unit_of_time_that_cannot_be(tmp_path):
    cells = [str(1714728000000 + k) for k in range(N)]
    with pytest.raises(BenchError, match=r"line 2: t '1714728000000' cannot be in s.*`time_unit`"):
        read(tmp_path, table(time=cells))


LONG = 4000
RECORD = """\
schema: 1
valve_system: open_centre
time: t
channels:
  left_pressure: {from: p, unit: bar}
"""


def record(folder: Path, time, head="t,p", mapping=RECORD):
    (folder / "m.yaml").write_text(mapping)
    values = 5.0 + np.sin(np.arange(len(time)) / 300.0)
    rows = "".join(f"{t},{p:.6f}\n" for t, p in zip(time, values, strict=True))
    (folder / "drive.csv").write_text(f"{head}\n{rows}")
    return read_record(folder / "drive.csv", folder / "m.yaml"), values


def test_the_unit_of_time_in_the_file_is_used_or_told(tmp_path):
    got, _ = record(tmp_path, range(LONG), "t,p\nms,bar")
    assert len(got) == LONG
    seconds = RECORD.replace("time: t", "time: t\ntime_unit: s")
    times = [f"{k / 1000:.3f}" for k in range(LONG)]
    got, _ = record(tmp_path, times, "t [ms],p", seconds)
    assert len(got) == LONG
    assert any("its time is in 'ms', the mapping 's'" in note for note in got.notes)


def test_time_that_starts_again_is_named_and_small_disorder_is_sorted(tmp_path):
    times = [f"{k / 1000:.3f}" for k in range(LONG)]
    with pytest.raises(BenchError, match=r"time starts again at line 4002 \(0 s after 3.999 s\)"):
        record(tmp_path, times + times)
    swapped = [*times[:100], times[101], times[100], *times[102:]]
    got, _ = record(tmp_path, swapped)
    assert any("time went back 1 times" in note and "line 103" in note for note in got.notes)
    got, _ = record(tmp_path, times[2000:] + times[:2000])
    assert len(got) == LONG


def test_time_that_lost_its_digits_is_named(tmp_path):
    with pytest.raises(BenchError, match=r"instants repeat .*line 3.*lost its last digits"):
        record(tmp_path, [f"{k // 1000}" for k in range(LONG)])


def test_a_column_of_one_channel_with_a_rate(tmp_path):
    channels = {"left_pressure": {"from": "p", "unit": "bar"}}
    for row in ("{:.2f}", "{:.3f}"):
        data = "p\n" + "".join(row.format(p).replace(".", ",") + "\n" for p in P)
        raw = read(tmp_path, data, time="", rate=1000.0, channels=channels, decimal=",")
        np.testing.assert_array_equal(raw.values, P)
    rated = {"time": "", "rate": 1000.0, "channels": channels}
    with pytest.raises(BenchError, match="line 3 is blank"):
        read(tmp_path, data.replace("\n5,7", "\n\n5,7"), **rated)
    with pytest.raises(BenchError, match="the header stands in line 13 again"):
        read(tmp_path, table().replace("\n0.011", "\nt,p\n0.011"), **rated)
    with pytest.raises(BenchError, match="line 13 is a row of texts"):
        read(tmp_path, table().replace("\n0.011", "\nt,q\n0.011"), **rated)


@pytest.mark.parametrize(
    ("key", "value"),
    [("separator", "ab"), ("separator", "1"), ("encoding", "utf-99"), ("header_line", 0)],
)
def test_a_key_that_makes_no_sense_is_refused(tmp_path, key, value):
    (tmp_path / "m.yaml").write_text(f"{RECORD}{key}: {value}\n")
    (tmp_path / "drive.csv").write_text(table())
    with pytest.raises(BenchError, match=key):
        read_record(tmp_path / "drive.csv", tmp_path / "m.yaml")


def test_a_header_with_other_columns_far_below_is_named(tmp_path):
    times = [f"{k / 1000:.3f}" for k in range(LONG)]
    times[2000] = "p,t\n2.000"
    with pytest.raises(BenchError, match=r"line 2002: a header with other columns"):
        record(tmp_path, times)
