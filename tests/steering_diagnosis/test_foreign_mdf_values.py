"""MDF channels as other tools store them: the physical value, a counted gap, or a refusal."""

from typing import Any

import numpy as np
import pytest
from asammdf.blocks import v4_constants as v4
from asammdf.blocks.conversion_utils import from_dict
from asammdf.blocks.v4_blocks import ChannelConversion
from hypothesis import given, settings
from hypothesis import strategies as st
from mdf_files import ANGLE, CHANNELS, LEFT, N, check, plain, read, refused, signal, written

from steering_diagnosis.data.units import FACTORS, same, spelled


def test_a_text_beside_numbers_is_a_gap(tmp_path):
    scale = from_dict({"a": 1e-3, "b": 0.0})
    raw = np.round(LEFT * 1e3).astype("u2")
    raw[500:520] = 65535
    raw[700:706] = 65534
    rule = from_dict(
        {
            "val_0": 65535.0,
            "text_0": b"SNA",
            "val_1": 65534.0,
            "text_1": b"Fault",
            "default_addr": scale,
        }
    )
    path = written(tmp_path, plain(pL=signal(raw, "pL", "bar", conversion=rule)))
    record = read(path)
    check(record, [*range(500, 520), *range(700, 706)], tolerance=1e-4)
    told = " ".join(record.notes)
    assert "'SNA' (20)" in told
    assert "'Fault' (6)" in told
    assert "26 of 2600" in told


def test_a_table_of_ranges_has_a_scale_for_each(tmp_path):
    """As a logger makes it of a signal with a plain part and error codes above."""
    scale = from_dict({"a": 1e-3, "b": 0.0})
    raw = np.round(LEFT * 1e3).astype("u2")
    raw[500:520] = 65100
    rule = from_dict(
        {
            "lower_0": 0.0,
            "upper_0": 64255.0,
            "text_0": scale,
            "lower_1": 64256.0,
            "upper_1": 65535.0,
            "text_1": b"error",
        }
    )
    path = written(tmp_path, plain(pL=signal(raw, "pL", "bar", conversion=rule)))
    check(read(path), range(500, 520), tolerance=1e-4)
    floats = np.where(np.isin(np.arange(N), range(500, 520)), -1.5, LEFT)
    rule = from_dict(
        {"val_0": -1.5, "text_0": b"SNA", "default_addr": from_dict({"a": 1.0, "b": 0})}
    )
    path = written(tmp_path, plain(pL=signal(floats, "pL", "bar", conversion=rule)))
    check(read(path), range(500, 520))


def test_a_channel_of_texts_alone_is_left_out_and_told(tmp_path):
    rule = from_dict({"val_0": 0, "text_0": b"off", "val_1": 1, "text_1": b"on"})
    path = written(
        tmp_path, plain(pL=signal((LEFT > 5).astype("u1"), "pL", "bar", conversion=rule))
    )
    record = read(path)
    assert "left_pressure" not in record
    assert any("left_pressure: left out" in n and "'off'" in n for n in record.notes)
    check(record, names=("steering_wheel_angle", "right_pressure"))
    only = "channels:\n  left_pressure: {from: pL, unit: bar}\n"
    refused(path, only, "left_pressure: left out", "'on'")


def test_numbers_for_texts(tmp_path):
    table: dict[str, Any] = {"val_0": 1.0, "val_1": 2.0, "val_default": np.nan}
    rule = ChannelConversion(conversion_type=v4.CONVERSION_TYPE_TTAB, links_nr=6, **table)
    rule.referenced_blocks = {"text_0": b"low", "text_1": b"high"}
    words = np.where(LEFT > 5, b"high", b"low")
    words[500:520] = b"?"
    made = signal(words, "pL", "bar", conversion=rule, encoding="utf-8")
    record = read(written(tmp_path, plain(pL=made)))
    wanted = np.where(LEFT > 5, 2e5, 1e5)
    wanted[500:520] = np.nan
    np.testing.assert_allclose(record["left_pressure"], wanted[: len(record)])
    assert any("'?' (20)" in note for note in record.notes)


@pytest.mark.parametrize("raw", ["f4", "f8", "<u2", ">u2", "<i4", ">i4", "u4", "f2"])
@pytest.mark.parametrize(
    "rule",
    [
        {"a": 1e-3, "b": -0.5},
        {"P1": 0.0, "P2": 1.0, "P3": -500.0, "P4": 0.0, "P5": 0.0, "P6": 1000.0},
        {"P1": 1.0, "P2": 0.0, "P3": 0.0, "P4": 0.0, "P5": 1e3, "P6": 0.0},
        {"formula": "(X - 500) / 1000"},
        {"raw_0": 0.0, "phys_0": -0.5, "raw_1": 1e4, "phys_1": 9.5, "interpolation": True},
    ],
)
def test_conversions_of_every_raw_type(tmp_path, raw, rule):
    """The rule is computed in double precision, whatever the raw type is."""
    wanted = LEFT * 1e3 + 500.0
    samples = np.round(wanted).astype(raw) if raw[-2] in "ui" else wanted.astype(raw)
    path = written(tmp_path, plain(pL=signal(samples, "pL", "bar", conversion=from_dict(rule))))
    record = read(path)
    exact = samples.astype(float)
    physical = exact / 1e3 if rule.get("P5") else (exact - 500.0) / 1e3
    np.testing.assert_allclose(record["left_pressure"], physical[: len(record)] * 1e5, rtol=1e-6)


def test_a_formula_that_cannot_be_computed_is_no_raw_value(tmp_path):
    rule = from_dict({"formula": "frobnicate(X) + 1"})
    path = written(tmp_path, plain(pL=signal(LEFT, "pL", "bar", conversion=rule)))
    refused(path, CHANNELS, "'pL'", "formula 'frobnicate(X) + 1'")


def test_a_table_of_ranges_to_numbers(tmp_path):
    rule = from_dict(
        {
            "lower_0": 0,
            "upper_0": 4,
            "phys_0": 1.0,
            "lower_1": 5,
            "upper_1": 9,
            "phys_1": 2.0,
            "default": 7.0,
        }
    )
    raw = np.arange(N).astype("u2") % 12
    path = written(tmp_path, plain(pL=signal(raw, "pL", "bar", conversion=rule)))
    wanted = np.select([raw <= 4, raw <= 9], [1.0, 2.0], 7.0)[:N] * 1e5
    record = read(path)
    np.testing.assert_allclose(record["left_pressure"], wanted[: len(record)])


def test_bits_packed_into_a_record(tmp_path):
    """12 bits signed at bit 4, then a flag: offsets within bytes, as buses have them."""
    counts = np.round(ANGLE * 50).astype("i2")
    packed = ((counts.astype("u2") & 0xFFF) << 4).astype("u2")

    def change(file):
        block = file.groups[0].channels[1]
        block.bit_offset, block.bit_count = 4, 12
        block.data_type = v4.DATA_TYPE_SIGNED_INTEL
        block.dtype_fmt = np.dtype("<i2")

    rule = from_dict({"a": 0.02, "b": 0.0})
    path = written(
        tmp_path, plain(angle=signal(packed, "angle", "deg", conversion=rule)), change=change
    )
    check(read(path), tolerance=1e-3)


def test_invalidation_bits_are_gaps_and_counted(tmp_path):
    invalid = np.zeros(N, bool)
    invalid[500:520] = True
    bad = np.where(invalid, 999.0, LEFT)
    path = written(tmp_path, (plain(pL=signal(bad, "pL", "bar", invalidation_bits=invalid)), {}))
    record = read(path)
    check(record, range(500, 520))
    assert any("20 samples are marked invalid" in note for note in record.notes)
    assert any("20 of 2600" in note for note in record.notes)


def test_a_channel_that_is_all_invalid_is_left_out(tmp_path):
    def change(file):
        file.groups[0].channels[2].flags |= v4.FLAG_CN_ALL_INVALID

    record = read(written(tmp_path, plain(), change=change))
    assert "left_pressure" not in record
    assert any("left_pressure: left out" in n and "invalid" in n for n in record.notes)


@settings(max_examples=25, deadline=None)
@given(
    raw=st.sampled_from(["f4", "f8", "u2", "i4"]),
    slope=st.sampled_from([0.01, 0.5, 2.0]),
    zero=st.floats(-5, 5),
    rate=st.sampled_from([400.0, 1000.0, 1600.0]),
    begin=st.floats(0, 100),
    bad=st.sets(st.integers(1, 80), max_size=3),
    texts=st.booleans(),
    version=st.sampled_from(["4.00", "4.10", "4.20"]),
    compression=st.sampled_from([0, 1, 2]),
    data=st.data(),
)
def test_whatever_a_channel_is_made_of(
    tmp_path_factory, raw, slope, zero, rate, begin, bad, texts, version, compression, data
):
    """Independent route: the physical values are known before they are packed."""
    folder = tmp_path_factory.mktemp("mdf")
    count = int(2.5 * rate)
    time = begin + np.arange(count) / rate
    physical = 5.0 + 3.0 * np.sin(2 * np.pi * 0.9 * (time - begin))
    counts = (physical - zero) / slope + (2000 if raw == "u2" else 0)
    samples = np.round(counts).astype(raw) if raw in ("u2", "i4") else counts.astype(raw)
    offset = zero - (2000 * slope if raw == "u2" else 0)
    physical = samples.astype(float) * slope + offset
    rule = {"a": slope, "b": offset}
    gone = np.zeros(count, bool)
    for block in bad:
        gone[10 * block : 10 * block + 10] = True
    if texts:
        samples = np.where(gone, np.array(60000).astype(raw), samples)
        rule = {"val_0": 60000.0, "text_0": b"SNA", "default_addr": from_dict(rule)}
    made = signal(
        samples,
        "p",
        "bar",
        time,
        conversion=from_dict(rule),
        invalidation_bits=None if texts or not bad else gone,
    )
    other = signal(np.arange(count, dtype="u1"), "q", "V", time)
    first = data.draw(st.booleans())
    signals = [other, made] if first else [made, other]
    path = written(
        folder, signals, [signal(np.zeros(N), "p")], version=version, compression=compression
    )
    record = read(path, "channels:\n  left_pressure: {from: p, group: 0, unit: bar}\n")
    grid = begin + np.arange(len(record)) * 1e-3
    kept = time[~gone]
    here = record["left_pressure"]
    assert len(record) == pytest.approx((kept[-1] - kept[0]) * 1e3 + 1, abs=1.01)
    if kept[0] != time[0]:
        grid += kept[0] - time[0]
    found = np.isfinite(here)
    # A gap is lost, and no more than it.
    inside = np.interp(grid, time, gone.astype(float)) > 0
    inside |= np.roll(inside, 1) | np.roll(inside, -1)
    assert not (~found & ~inside).any()
    if rate <= 1000.0:
        wanted = np.interp(grid, kept, physical[~gone]) * 1e5
        np.testing.assert_allclose(here[found], wanted[found], rtol=1e-5)
    else:
        wanted = (5.0 + 3.0 * np.sin(2 * np.pi * 0.9 * (grid - begin))) * 1e5
        assert np.median(np.abs(here[found] - wanted[found])) < 0.6e5 * max(slope, 0.02)
    assert any("no numbers" in note for note in record.notes) == bool(gone.any())


@pytest.mark.parametrize(
    ("in_file", "mapped"),
    [
        ("°", "deg"),
        ("Grad", "deg"),
        ("degree", "°"),
        ("[deg]", "deg"),
        ("deg", "degrees"),
    ],
)
def test_spellings_of_a_unit_are_one_unit(tmp_path, in_file, mapped):
    path = written(tmp_path, plain(angle=signal(ANGLE, "angle", in_file)))
    record = read(path, CHANNELS.replace("unit: deg", f"unit: '{mapped}'"))
    check(record)
    assert not any("unit" in note for note in record.notes)


def test_a_unit_that_contradicts_the_mapping_is_told(tmp_path):
    for unit in ("rad", "grad", "V"):
        path = written(tmp_path, plain(angle=signal(ANGLE, "angle", unit)))
        assert any(f"'{unit}'" in n and "'deg'" in n for n in read(path).notes)


def test_a_mapping_without_units_takes_the_file_s(tmp_path):
    path = written(tmp_path, plain())
    bare = CHANNELS.replace(", unit: deg", "").replace(", unit: bar", "")
    record = read(path, bare)
    check(record)
    assert any("left_pressure: in 'bar', as the file says" in note for note in record.notes)
    path = written(tmp_path, plain(pL=signal(LEFT, "pL")))
    refused(path, bare, "left_pressure", "no unit", "'unit'")
    path = written(tmp_path, plain(pL=signal(LEFT, "pL", "furlong")))
    refused(path, bare, "left_pressure", "'furlong'")


def test_the_unit_of_the_conversion_counts_where_the_channel_has_none(tmp_path):
    rule = from_dict({"a": 10.0, "b": 0.0})
    rule.unit = "mbar"

    path = written(tmp_path, plain(pL=signal(LEFT * 100, "pL", "", conversion=rule)))
    check(read(path, CHANNELS.replace("{from: pL, unit: bar}", "{from: pL}")))


@pytest.mark.parametrize(
    ("unit", "spellings"),
    [
        ("deg", ["°", "deg", "Grad", "degree", "degrees", "[°]", " deg ", "Deg"]),
        ("deg/s", ["°/s", "deg/s", "degree/sec", "Grad/s", "deg s^-1", "dps", "deg*s-1"]),
        ("rad/s", ["rad/s", "rad/sec", "rad s-1", "rad·s⁻¹"]),
        ("rpm", ["1/min", "rpm", "U/min", "min^-1", "r/min"]),
        ("N m", ["Nm", "N m", "N.m", "N*m", "N·m", "N-m", "(Nm)"]),
        ("MPa", ["MPa", "Mpa", "N/mm²", "N/mm2"]),
        ("hPa", ["hPa", "mbar"]),
        ("bar", ["bar", "Bar", "BAR"]),
        ("lbf", ["lbf", "lb"]),
        ("us", ["µs", "μs", "us"]),
    ],
)
def test_one_unit_has_many_spellings(unit, spellings):
    quantity = next(q for q, known in FACTORS.items() if unit in known)
    for spelling in spellings:
        assert same(spelling, unit, quantity), spelling


@pytest.mark.parametrize(
    ("unit", "quantity"),
    [
        ("grad", "rad"),
        ("mPa", "Pa"),
        ("bara", "Pa"),
        ("MN", "N"),
        ("Nm", "N"),
        ("M", "m"),
        ("", "s"),
    ],
)
def test_what_is_no_spelling_of_a_unit(unit, quantity):
    assert spelled(unit) not in FACTORS[quantity]


def test_a_spelling_stands_for_one_unit_and_factors_are_exact():
    for known in FACTORS.values():
        for name in known:
            assert spelled(name) == name
    # Conversion factors of NIST SP 811, appendix B.8, to the digits given there.
    assert FACTORS["Pa"]["psi"] == pytest.approx(6.894757e3, rel=1e-7)
    assert FACTORS["N m"]["lbf ft"] == pytest.approx(1.355818, rel=1e-6)
    assert FACTORS["N m"]["lbf in"] == pytest.approx(0.1129848, rel=1e-6)
    assert FACTORS["Pa"]["kp/cm2"] == pytest.approx(9.80665e4)
    assert FACTORS["rad/s"]["rpm"] == pytest.approx(0.1047198, rel=1e-6)
