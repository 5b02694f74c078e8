"""What no steering gear can have measured never passes silently, through any door."""

import re
import warnings
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.io import savemat

from steering_core.errors import BenchError
from steering_diagnosis.data.channels import CHANNELS
from steering_diagnosis.data.cut import cut
from steering_diagnosis.data.plausible import measured
from steering_diagnosis.data.read import read_record
from steering_diagnosis.data.record import Record

N = 3000
TIME = np.arange(N) * 1e-3
ANGLE = 20.0 * np.sin(2.0 * np.pi * 0.7 * TIME)
PRESSURE = 5.0 + 3.0 * np.sin(2.0 * np.pi * 0.7 * TIME)
CHANNEL_LINES = (
    "  steering_wheel_angle: {from: angle, unit: deg}\n  left_pressure: {from: pL, unit: bar}\n"
)
HEAD = "schema: 1\nvalve_system: open_centre\ntime: t\n"
MAPPING = f"{HEAD}channels:\n{CHANNEL_LINES}"


def read(folder: Path, cells: dict[str, np.ndarray] | None = None, text: str = MAPPING) -> Record:
    """The record of a CSV file with some columns changed; any warning is an error."""
    columns = {"t": TIME, "angle": ANGLE, "pL": PRESSURE} | (cells or {})
    rows = zip(*columns.values(), strict=True)
    path = folder / "drive.csv"
    path.write_text("t,angle,pL\n" + "".join(",".join(f"{v:.9g}" for v in r) + "\n" for r in rows))
    mapping = folder / "mapping.yaml"
    mapping.write_text(text)
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        return read_record(path, mapping)


def with_values(values: np.ndarray, rows: slice, value: float) -> np.ndarray:
    changed = values.copy()
    changed[rows] = value
    return changed


@pytest.mark.parametrize("value", [-9999.0, -999.0, 99999.0, 65535.0, 1e300, -1e308])
@pytest.mark.parametrize("count", [1, 30])
def test_a_sentinel_is_a_gap_and_told_with_count_place_and_remedy(value, count, tmp_path):
    record = read(tmp_path, {"pL": with_values(PRESSURE, slice(500, 500 + count), value)})
    good = np.isfinite(record["left_pressure"])
    np.testing.assert_allclose(record["left_pressure"][good], PRESSURE[good] * 1e5, atol=20.0)
    assert np.count_nonzero(~good) == (count if count > 4 else 0)
    (told,) = [note for note in record.notes if "missing:" in note]
    for words in ("left_pressure", f"{count} of {N}", "line 502", f"missing: [{value:g}]"):
        assert words in told


def test_a_sentinel_within_the_range_is_found_by_standing_far_from_all_others(tmp_path):
    record = read(tmp_path, {"angle": with_values(ANGLE, slice(7, 1000, 100), -999.0)})
    assert np.nanmin(record["steering_wheel_angle"]) > np.radians(-21.0)
    assert any("missing: [-999]" in note and "line 9" in note for note in record.notes)


def test_a_value_of_the_measurement_is_no_sentinel(tmp_path):
    turned = np.linspace(-1200.0, 1200.0, N)
    turned[np.argmin(np.abs(turned + 999.0))] = -999.0
    record = read(tmp_path, {"angle": turned})
    np.testing.assert_allclose(record["steering_wheel_angle"], np.radians(turned), atol=1e-6)
    assert not any("missing:" in note for note in record.notes)


def test_a_wrong_unit_is_an_error_that_names_unit_and_missing(tmp_path):
    with pytest.raises(BenchError, match=r"left_pressure: .* -10 to 1000 bar .*`unit`.*missing:"):
        read(tmp_path, {"pL": PRESSURE * 1e5})


def test_missing_counts_for_files_of_all_kinds(tmp_path):
    path, mapping = tmp_path / "drive.mat", tmp_path / "mapping.yaml"
    gone = with_values(PRESSURE, slice(500, 600), 42.0)
    savemat(path, {"t": TIME, "angle": ANGLE, "pL": gone})
    mapping.write_text(MAPPING + "missing: 42\n")
    record = read_record(path, mapping)
    assert np.count_nonzero(~np.isfinite(record["left_pressure"])) == 100


@given(
    name=st.sampled_from(sorted(CHANNELS)),
    values=st.lists(st.floats(allow_nan=True), min_size=1, max_size=40),
)
def test_what_passes_is_within_the_limits_and_the_rest_is_told(name, values):
    raw = np.array(values)
    channel = CHANNELS[name]
    try:
        kept, notes = measured(name, raw, raw, 1.0, channel.unit, None)
    except BenchError:
        assert not np.all((raw >= channel.low) & (raw <= channel.high))
        return
    left = raw[kept & np.isfinite(raw)]
    assert np.all((left >= channel.low) & (left <= channel.high))
    assert bool(notes) == bool(np.any(~kept))


@pytest.mark.parametrize(
    ("step", "unit"),
    [(1.0, "ms"), (1e3, "us"), (1e6, "ns"), (5.0, "ms"), (0.5, "ms")],
)
def test_a_step_that_no_record_has_names_the_unit_of_time(step, unit, tmp_path):
    shown = re.escape(f"{step:.3g}")
    with pytest.raises(BenchError, match=rf"{shown} s apart.*`time_unit: {unit}`"):
        read(tmp_path, {"t": np.arange(N) * step})


def test_the_right_unit_of_time_passes(tmp_path):
    record = read(tmp_path, {"t": TIME * 1e3}, MAPPING + "time_unit: ms\n")
    assert len(record) == N


@pytest.mark.parametrize("at", [0, 700, N - 1])
@pytest.mark.parametrize("instant", [-9999.0, 1.7e9])
def test_a_stray_instant_costs_itself_only(at, instant, tmp_path):
    record = read(tmp_path, {"t": with_values(TIME, slice(at, at + 1), instant)})
    assert len(record) >= N - 2
    assert any("far from all others" in note and f"line {at + 2}" in note for note in record.notes)


def test_a_column_is_one_channel_only(tmp_path):
    twice = HEAD + (
        "channels:\n  left_pressure: {from: pL, unit: bar}\n"
        "  right_pressure: {from: pL, unit: bar}\n"
    )
    with pytest.raises(BenchError, match="right_pressure: 'pL' is left_pressure already"):
        read(tmp_path, text=twice)
    with pytest.raises(BenchError, match="left_pressure: 't' is the time already"):
        read(tmp_path, text=HEAD + "channels:\n  left_pressure: {from: t, unit: bar}\n")


def test_two_columns_with_the_same_numbers_are_told(tmp_path):
    record = read(tmp_path, {"angle": PRESSURE})
    assert any("written twice" in note for note in record.notes)


def test_how_a_table_was_read_is_told_in_one_line(tmp_path):
    (told,) = [note for note in read(tmp_path).notes if note.startswith("read as: ")]
    for words in ("utf-8", "separator comma", "point", "header in line 1", f"{N} rows", "'t'"):
        assert words in told


@pytest.mark.parametrize(
    ("start", "stop", "told"),
    [
        (float("nan"), None, "--from must be"),
        (None, float("inf"), "--to must be"),
        (-1.0, None, "--from must be"),
        (5.0, 2.0, "--to 2 is not after --from 5"),
        (1e6, None, "lasts 3.000 s"),
    ],
)
def test_a_part_that_is_none_is_refused(start, stop, told, tmp_path):
    with pytest.raises(BenchError, match=told):
        cut(read(tmp_path), start, stop)


def test_channels_that_share_too_little_are_named_with_their_delay(tmp_path):
    late = CHANNEL_LINES.replace("unit: bar", "unit: bar, delay: 0.9")
    with pytest.raises(BenchError, match=r"left_pressure \(delay 0.9 s\) ends at 1.1993 s"):
        read(tmp_path, {"t": TIME * 0.7}, f"{HEAD}channels:\n{late}")
