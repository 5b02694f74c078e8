"""Measured data of other tools: what is in the file comes back in SI, and what is odd is said."""

import re
from pathlib import Path

import numpy as np
import pytest
from scipy.io import savemat

from steering_core.errors import BenchError
from steering_diagnosis.data.read import read_record

SECONDS = 6.0
TIME = np.arange(0.0, SECONDS, 1e-3)
ANGLE = np.radians(20.0) * np.sin(2.0 * np.pi * 0.7 * TIME)
SPEED = np.radians(20.0) * 2.0 * np.pi * 0.7 * np.cos(2.0 * np.pi * 0.7 * TIME)
PRESSURE = 1e5 * (5.0 + 3.0 * np.sin(2.0 * np.pi * 0.7 * TIME))

MAPPING = """\
schema: 1
valve_system: open_centre
time: t
channels:
  steering_wheel_angle: {from: angle, unit: deg, sign: -1}
  left_pressure: {from: pL, unit: bar}
"""


def mapping(folder: Path, text: str = MAPPING) -> Path:
    path = folder / "mapping.yaml"
    path.write_text(text)
    return path


def csv(
    folder: Path, time=TIME, angle=ANGLE, pressure=PRESSURE, separator=",", head="t,angle,pL\n"
):
    rows = zip(time, -np.degrees(angle), pressure * 1e-5, strict=True)
    lines = [separator.join(f"{v:.9g}" for v in row) for row in rows]
    path = folder / "drive.csv"
    path.write_text(head.replace(",", separator) + "\n".join(lines) + "\n")
    return path


def mdf(folder: Path, groups: list[dict[str, tuple[np.ndarray, np.ndarray, str]]]) -> Path:
    from asammdf import MDF, Signal

    path = folder / "drive.mf4"
    with MDF() as file:
        for group in groups:
            file.append(
                [
                    Signal(samples=values, timestamps=time, name=name, unit=unit)
                    for name, (time, values, unit) in group.items()
                ]
            )
        file.save(path)
    return path


def test_a_csv_file_comes_back_in_si_with_the_bench_signs(tmp_path):
    record = read_record(csv(tmp_path), mapping(tmp_path))
    assert len(record) == len(TIME)
    np.testing.assert_allclose(record["steering_wheel_angle"], ANGLE, atol=1e-8)
    np.testing.assert_allclose(record["left_pressure"], PRESSURE, atol=1.0)
    assert any("not measured" in note and "rack_position" in note for note in record.notes)


def test_semicolons_decimal_commas_and_a_line_of_units(tmp_path):
    path = csv(tmp_path, separator=";", head="t,angle,pL\ns,deg,bar\n")
    path.write_text(path.read_text().replace(".", ","))
    record = read_record(path, mapping(tmp_path))
    np.testing.assert_allclose(record["left_pressure"], PRESSURE, atol=1.0)


def test_a_unit_that_contradicts_the_mapping_is_told(tmp_path):
    path = csv(tmp_path, head="t,angle,pL\ns,rad,bar\n")
    record = read_record(path, mapping(tmp_path))
    assert any("'rad'" in note and "'deg'" in note for note in record.notes)


def test_a_matlab_structure_is_read(tmp_path):
    path = tmp_path / "drive.mat"
    savemat(path, {"run": {"t": TIME, "angle": -np.degrees(ANGLE), "pL": PRESSURE * 1e-5}})
    text = MAPPING.replace("time: t", "time: run.t").replace("from: ", "from: run.")
    record = read_record(path, mapping(tmp_path, text))
    np.testing.assert_allclose(record["steering_wheel_angle"], ANGLE, atol=1e-8)


def test_an_mdf_file_with_a_rate_for_each_group(tmp_path):
    slow = TIME[::10]
    groups = [
        {"angle": (TIME, -np.degrees(ANGLE), "deg")},
        {"pL": (slow, PRESSURE[::10] * 1e-5, "bar")},
    ]
    text = MAPPING.replace("time: t\n", "")
    record = read_record(mdf(tmp_path, groups), mapping(tmp_path, text))
    kept = slice(0, len(record))
    assert np.max(np.abs(record["left_pressure"] - PRESSURE[kept])) < 1e5 * 3.0 * (4.4e-2) ** 2
    assert any(
        "left_pressure: sampled at 100 Hz" in note and "50 Hz" in note for note in record.notes
    )


def test_a_fast_channel_is_low_passed_before_it_is_thinned(tmp_path):
    time = np.arange(0.0, SECONDS, 1e-4)
    angle = np.radians(20.0) * np.sin(2.0 * np.pi * 0.7 * time)
    aliased = angle + 0.01 * np.sin(2.0 * np.pi * 1003.0 * time)
    path = csv(tmp_path, time, aliased, np.full_like(time, 5e5) + 1e3 * np.sin(time))
    record = read_record(path, mapping(tmp_path))
    inner = slice(50, -50)
    assert np.max(np.abs(record["steering_wheel_angle"] - ANGLE[: len(record)])[inner]) < 2e-4


def test_gaps_repeats_and_non_numbers_are_told_and_not_bridged(tmp_path):
    keep = (TIME < 2.0) | (TIME > 2.5)
    time, angle, pressure = TIME[keep].copy(), ANGLE[keep].copy(), PRESSURE[keep].copy()
    angle[100:110] = np.nan
    time[301] = time[300]
    record = read_record(csv(tmp_path, time, angle, pressure), mapping(tmp_path))
    told = " ".join(record.notes)
    assert "10 of" in told
    assert "no numbers" in told
    assert "repeated instants" in told
    assert "1 gaps" in told
    assert np.all(np.isnan(record["left_pressure"][2010:2490]))
    assert np.count_nonzero(np.isnan(record["left_pressure"])) < 520


def test_jitter_and_coarse_steps_are_told(tmp_path):
    random = np.random.default_rng(1)
    time = TIME + random.uniform(-3e-4, 3e-4, len(TIME))
    pressure = 0.5e5 * np.round(PRESSURE / 0.5e5)
    record = read_record(csv(tmp_path, time, ANGLE, pressure), mapping(tmp_path))
    assert any("jitter" in note for note in record.notes)
    assert any("left_pressure: quantised in steps of 5e+04" in note for note in record.notes)


def test_a_second_clock_is_found_and_corrected(tmp_path):
    """The wheel's speed tells when the wheel moves; its clock is 40 ms late and drifts."""
    seconds = np.arange(0.0, 20.0, 1e-3)
    steer = np.sin(2.0 * np.pi * (0.2 + 0.05 * seconds) * seconds)
    rate = np.gradient(steer, 1e-3)
    shown = 0.040 + (1.0 + 200e-6) * seconds
    groups = [{"angle": (seconds, -steer, "rad")}, {"w": (shown, rate, "rad/s")}]
    text = """\
schema: 1
valve_system: open_centre
clocks: {logger: {estimate: true}}
channels:
  steering_wheel_angle: {from: angle, unit: rad, sign: -1}
  steering_wheel_speed: {from: w, unit: rad/s, clock: logger}
"""
    record = read_record(mdf(tmp_path, groups), mapping(tmp_path, text))
    derived = np.gradient(record["steering_wheel_angle"], 1e-3)
    inner = slice(100, -100)
    error = (record["steering_wheel_speed"] - derived)[inner]
    assert np.nanmax(np.abs(error)) < 0.02 * np.max(np.abs(rate))
    note = next(note for note in record.notes if "logger" in note)
    late, drift = (float(word) for word in re.findall(r"(\d+\.?\d*) (?:ms late|ppm)", note))
    assert late == pytest.approx(40.0, abs=0.5)
    assert drift == pytest.approx(200.0, abs=20.0)


@pytest.mark.parametrize(
    ("change", "words"),
    [
        (("unit: deg", "unit: bar"), ("unit 'bar'", "deg")),
        (("left_pressure:", "left_presure:"), ("left_presure", "did you mean 'left_pressure'")),
        (("from: pL", "from: pLeft"), ("column 'pLeft'",)),
        (("time: t", "time: tt"), ("column 'tt'",)),
        (("sign: -1", "sign: 0"), ("sign",)),
        (("time: t\n", ""), ("no time", "rate")),
        (("schema: 1", "schema: 1\nparameters: {mechanics.rack_mas: 3}"), ("rack_mass",)),
    ],
)
def test_a_wrong_mapping_is_one_clear_line(tmp_path, change, words):
    path = csv(tmp_path)
    with pytest.raises(BenchError) as caught:
        read_record(path, mapping(tmp_path, MAPPING.replace(*change)))
    for word in words:
        assert word in str(caught.value)


def test_ten_samples_and_a_text_among_the_numbers(tmp_path):
    with pytest.raises(BenchError, match="too few"):
        read_record(csv(tmp_path, TIME[:10], ANGLE[:10], PRESSURE[:10]), mapping(tmp_path))
    path = csv(tmp_path)
    lines = path.read_text().splitlines()
    lines[500] = "0.499,err,5"
    path.write_text("\n".join(lines))
    record = read_record(path, mapping(tmp_path))
    assert any("1 of 6000 samples" in n and "'err' first in line 501" in n for n in record.notes)


def test_a_file_of_something_else(tmp_path):
    picture = tmp_path / "drive.png"
    picture.write_bytes(b"no data")
    with pytest.raises(BenchError, match=r"kind of file '\.png'"):
        read_record(picture, mapping(tmp_path))
    broken = tmp_path / "drive.mf4"
    broken.write_bytes(b"no data")
    with pytest.raises(BenchError, match="cannot be read as MDF"):
        read_record(broken, mapping(tmp_path))
    with pytest.raises(BenchError, match="needs a mapping file"):
        read_record(csv(tmp_path))
