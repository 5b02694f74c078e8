"""MDF files as other tools write them: the channel and the time meant, or one line that refuses."""

from typing import Any

import numpy as np
import pytest
from asammdf import MDF, Source
from asammdf.blocks import v4_constants as v4
from asammdf.blocks.conversion_utils import from_dict
from mdf_files import (
    CHANNELS,
    LEFT,
    RIGHT,
    TRUE,
    N,
    T,
    check,
    left,
    plain,
    read,
    refused,
    signal,
    written,
)

from steering_core.errors import BenchError

# Which channel


TWICE = (
    "channels:\n  left_pressure: {from: p, unit: bar%s}\n  right_pressure: {from: p, unit: bar%s}\n"
)


@pytest.mark.parametrize(
    ("first", "second"),
    [
        ("group: 0", "group: 1"),
        ("group: left", "group: right"),
        ("source: ECU L", "source: ECU R"),
        ("source: CAN1", "source: CAN2"),
    ],
)
def test_one_name_in_two_groups(tmp_path, first, second):
    sources = [
        Source(name=f"ECU {s}", path=f"CAN{k}", comment="", source_type=1, bus_type=2)
        for k, s in ((1, "L"), (2, "R"))
    ]
    path = written(
        tmp_path,
        ([signal(LEFT, "p", "bar", source=sources[0])], {"acq_name": "left", "comment": "a"}),
        ([signal(RIGHT, "p", "bar", source=sources[1])], {"acq_name": "right", "comment": "b"}),
    )
    record = read(path, TWICE % (f", {first}", f", {second}"))
    check(record, names=("left_pressure", "right_pressure"))
    said = refused(path, TWICE % ("", ""), "'p' occurs 2 times", "group 0, index 1", "'CAN2'")
    assert "'group'" in said


def test_a_group_by_its_comment_and_a_group_that_is_not_there(tmp_path):
    path = written(
        tmp_path,
        ([signal(LEFT, "p")], {"comment": "<CGcomment><TX>Raster 1 ms</TX></CGcomment>"}),
        ([signal(RIGHT, "p")], {"comment": "Raster 10 ms"}),
    )
    both = TWICE % (", group: Raster 1 ms", ", group: 10 ms")
    check(read(path, both), names=("left_pressure", "right_pressure"))
    refused(path, TWICE % (", group: Raster 2 ms", ""), "group 'Raster 2 ms'", "did you mean")
    refused(path, TWICE % (", group: 7", ""), "no group 7", "0 to 1")


def test_one_name_twice_in_one_group_needs_its_index(tmp_path):
    path = written(tmp_path, [signal(LEFT, "p", "bar"), signal(RIGHT, "p", "bar")])
    check(
        read(path, TWICE % (", index: 1", ", group: 0, index: 2")),
        names=("left_pressure", "right_pressure"),
    )
    refused(path, TWICE % (", group: 0", ""), "index 1", "index 2", "'index'")
    refused(path, TWICE % (", index: 9", ""), "not there, but in group 0, index 1")


def test_device_names_behind_a_backslash(tmp_path):
    groups = [signal(LEFT, "p\\XCP:1\\CCP", "bar")], [signal(RIGHT, "p\\ETK:2", "bar")]
    path = written(tmp_path, *groups)
    text = TWICE.replace("from: p,", "from: 'p\\XCP:1\\CCP',", 1) % ("", "")
    text = text.replace("from: p,", "from: 'p\\ETK:2',")
    check(read(path, text), names=("left_pressure", "right_pressure"))
    refused(path, TWICE % ("", ""), "occurs 2 times")
    path = written(tmp_path, groups[0], [signal(RIGHT, "p", "bar")])
    text = "channels:\n  right_pressure: {from: p, unit: bar}\n"
    check(read(path, text), names=("right_pressure",))


def test_components_of_structures_and_elements_of_arrays(tmp_path):
    both = np.rec.fromarrays([LEFT, RIGHT], dtype=[("l", "<f8"), ("r", "<f8")])
    table = np.rec.fromarrays([np.stack([LEFT, RIGHT], axis=1)], dtype=[("a", "<f8", (2,))])
    path = written(tmp_path, [signal(both, "s")], [signal(table, "a")])
    text = TWICE.replace("from: p,", "from: %s,").replace("bar%s", "bar")
    for names in (("s.l", "s.r"), ("l", "r"), ("'a[0]'", "'a[1]'"), ("s.l", "'a[1]'")):
        check(read(path, text % names), names=("left_pressure", "right_pressure"))
    refused(path, text % ("s", "s.r"), "'s' is a structure", "s.l, s.r")
    refused(path, text % ("a", "s.r"), "'a' is an array", "a[0]")


def test_an_unknown_channel_and_what_is_no_number(tmp_path):
    texts = np.array([b"on"] * N)
    wide = np.zeros((N, 8), np.uint8)
    path = written(tmp_path, plain(), [signal(texts, "state", encoding="utf-8"), signal(wide, "b")])
    refused(path, left("from: pLeft, unit: bar"), "unknown channel 'pLeft'")
    refused(path, left("from: state, unit: bar"), "'state' does not hold plain numbers but texts")
    refused(path, left("from: b, unit: bar"), "'b' does not hold plain numbers but bytes")


# Time


def without_master(file):
    first = file.groups[0].channels[0]
    first.channel_type = first.sync_type = 0
    first.name = "Zeit"
    file.masters_db.clear()


def test_no_master_at_all(tmp_path):
    path = written(tmp_path, plain(), change=without_master)
    record = read(path, "rate: 1000\n" + CHANNELS)
    check(record)
    assert sum("taken at 1000 Hz" in note for note in record.notes) == 1
    check(read(path, "time: Zeit\n" + CHANNELS))
    refused(path, CHANNELS, "group 0 has no time", "'rate'", "Zeit, angle, pL")
    refused(path, "time: t\n" + CHANNELS, "no time", "no channel 't'")


def test_a_time_channel_in_milliseconds_that_is_no_master(tmp_path):
    time = signal(T * 1e3, "clock", "ms")
    path = written(tmp_path, [*plain(), time], change=without_master)
    check(read(path, "time: clock\n" + CHANNELS))
    check(read(path, "time: clock\ntime_unit: ms\n" + CHANNELS))
    record = read(path, "time: Zeit\ntime_unit: s\n" + CHANNELS)
    assert not any("time is in" in note for note in record.notes)
    path = written(tmp_path, [*plain(), signal(T * 1e3, "clock")], change=without_master)
    check(read(path, "time: clock\ntime_unit: msec\n" + CHANNELS))


@pytest.mark.parametrize(
    ("sync", "unit", "word"),
    [
        (v4.SYNC_TYPE_ANGLE, "rad", "angle"),
        (v4.SYNC_TYPE_DISTANCE, "m", "distance"),
        (v4.SYNC_TYPE_INDEX, "", "index"),
        (v4.SYNC_TYPE_TIME, "deg", "in 'deg', no unit of time"),
        (v4.SYNC_TYPE_NONE, "", "does not say that it is a time"),
    ],
)
def test_a_master_that_is_no_time(tmp_path, sync, unit, word):
    def change(file):
        file.groups[0].channels[0].sync_type = sync
        file.groups[0].channels[0].unit = unit

    clock = signal(T, "clock", "s")
    path = written(tmp_path, [*plain(), clock], change=change)
    refused(path, CHANNELS, word, "'rate'")
    check(read(path, "rate: 1000\n" + CHANNELS))
    check(read(path, "time: clock\n" + CHANNELS))


@pytest.mark.parametrize(("unit", "factor"), [("ms", 1e3), ("[us]", 1e6), ("sec", 1.0)])
def test_a_master_in_another_unit_than_seconds(tmp_path, unit, factor):
    def change(file):
        file.groups[0].channels[0].unit = unit

    signals = [signal(s.samples, s.name, s.unit, T * factor) for s in plain()]
    path = written(tmp_path, signals, change=change)
    check(read(path))
    if factor == 1e3:
        refused(path, "time_unit: us\n" + CHANNELS, "at least 2 s")


def virtual(conversion):
    def change(file):
        master = file.groups[0].channels[0]
        master.channel_type = v4.CHANNEL_TYPE_VIRTUAL_MASTER
        master.data_type = v4.DATA_TYPE_UNSIGNED_INTEL
        master.bit_count = 0
        master.conversion = conversion

    return change


def test_a_virtual_master_counts_by_its_conversion_only(tmp_path):
    path = written(tmp_path, plain(), change=virtual(from_dict({"a": 1e-3, "b": 0.0})))
    check(read(path))
    for rule in (None, from_dict({"a": 1.0, "b": 0.0})):
        path = written(tmp_path, plain(), change=virtual(rule))
        refused(path, CHANNELS, "only counts its samples", "'rate'")
        refused(path, "time: time\n" + CHANNELS, "only counts its samples")
        check(read(path, "rate: 1000\n" + CHANNELS))


def test_groups_with_clocks_of_their_own(tmp_path):
    """Other rates and beginnings: the record is what all have, every value at its own time."""
    slow, late = np.arange(-0.5, 3.0, 1e-2), np.arange(0.2, 2.7, 5e-4)
    path = written(
        tmp_path,
        [signal(20 * np.sin(2 * np.pi * 0.7 * slow), "angle", "deg", slow + 1.0)],
        [signal(5 + 3 * np.sin(2 * np.pi * 0.9 * late), "pL", "bar", late + 1.0)],
        [signal(RIGHT, "pR", "bar", T + 1.0)],
    )
    record = read(path)
    shared = 0.2 + np.arange(len(record)) * 1e-3
    assert shared[-1] == pytest.approx(2.599, abs=1e-3)
    wanted = np.interp(shared, T, RIGHT) * 1e5
    np.testing.assert_allclose(record["right_pressure"], wanted, rtol=1e-6)
    wanted = (5 + 3 * np.sin(2 * np.pi * 0.9 * shared)) * 1e5
    np.testing.assert_allclose(record["left_pressure"][20:-20], wanted[20:-20], rtol=1e-4)
    wanted = np.radians(20 * np.sin(2 * np.pi * 0.7 * shared))
    np.testing.assert_allclose(record["steering_wheel_angle"], wanted, atol=2e-3)


def test_repeated_and_falling_time_stamps_are_told(tmp_path):
    time = T.copy()
    time[500] = time[499]
    time[[900, 901]] = time[[901, 900]]
    values = LEFT.copy()
    values[[900, 901]] = values[[901, 900]]
    path = written(
        tmp_path,
        [signal(v.samples, v.name, v.unit, time) for v in plain(pL=signal(values, "pL", "bar"))],
    )
    told = " ".join(read(path).notes)
    assert "time went back 1 times, 1 repeated instants" in told


def test_a_group_without_samples(tmp_path):
    empty = signal(np.array([], float), "pL", "bar", np.array([], float))
    path = written(tmp_path, plain()[::2], [empty])
    refused(path, CHANNELS, "'pL' has no samples")


# Files


@pytest.mark.parametrize("suffix", [".mdf", ".dat"])
@pytest.mark.parametrize("version", ["2.14", "3.00", "3.30"])
def test_old_versions(tmp_path, version, suffix):
    raw = np.round(LEFT * 1e3).astype("u2")
    rule = from_dict({"a": 1e-3, "b": 0.0})
    path = written(
        tmp_path,
        plain()[::2],
        [signal(raw, "pL", "bar", conversion=rule)],
        version=version,
        name=f"drive{suffix}",
    )
    check(read(path), tolerance=1e-4)


def test_texts_beside_numbers_in_an_old_file(tmp_path):
    raw = np.round(LEFT * 1e3).astype("u2")
    raw[500:520] = 65535
    rule = from_dict({"lower_0": 65535.0, "upper_0": 65535.0, "text_0": b"SNA"})

    def change(file):
        blocks = file.groups[0].channels[2].conversion.referenced_blocks
        blocks["default_addr"] = b'ASAM-MCD2: "0.001*{X}+0.0"'

    signals = plain(pL=signal(raw, "pL", "bar", conversion=rule))
    path = written(tmp_path, signals, version="3.30", name="drive.mdf", change=change)
    check(read(path), range(500, 520), tolerance=1e-4)
    path = written(tmp_path, signals, version="3.30", name="drive.mdf")
    assert "left_pressure" not in read(path)


def test_columns_beside_each_other(tmp_path):
    """MDF 4.20's column storage keeps a master for several groups."""
    path = tmp_path / "drive.mf4"
    options: dict[str, Any] = {"column_storage": True}
    with MDF(version="4.20", **options) as file:
        file.append(plain())
        file.save(path, overwrite=True)
    check(read(path))


def test_a_file_that_is_no_mdf(tmp_path):
    for content, word in ((b"", "is empty"), (b"t;angle;pL\n0;1;2\n", "begins with b't;angle;'")):
        for suffix in (".mf4", ".dat"):
            path = tmp_path / f"drive{suffix}"
            path.write_bytes(content)
            refused(path, CHANNELS, "cannot be read as MDF", word)


def test_a_file_that_breaks_off_anywhere(tmp_path, capfd):
    """What is read is right as far as it goes and told, or the file is refused on one line."""
    rule = from_dict({"a": 1e-3, "b": 0.5})
    raw = np.round((LEFT - 0.5) * 1e3).astype("u2")
    signals = plain(pL=signal(raw, "pL", "bar", conversion=rule))
    whole = written(tmp_path, signals, name="whole.mf4").read_bytes()
    path, refusals = tmp_path / "drive.mf4", 0
    lengths = np.unique(
        np.linspace(1, len(whole) - 1, 60).astype(int).tolist()
        + [len(whole) - k for k in range(8, 4000, 100)]
    )
    for length in lengths:
        path.write_bytes(whole[:length])
        try:
            record = read(path)
        except BenchError:
            refusals += 1
            continue
        told = " ".join(record.notes)
        count = len(record)
        assert count >= N - 1 or "breaks off" in told
        for name, true in TRUE.items():
            if name in record:
                np.testing.assert_allclose(record[name], true[:count], rtol=1e-3, atol=1e-6)
    assert refusals > len(lengths) / 4
    out, err = capfd.readouterr()
    assert (out, err) == ("", "")


def test_a_file_that_its_logger_did_not_close(tmp_path):
    path = written(tmp_path, plain())
    content = bytearray(path.read_bytes())
    content[0:8] = b"UnFinMF "
    content[60:64] = (1).to_bytes(2, "little") + b"\0\0"
    path.write_bytes(content)
    record = read(path)
    check(record)
    assert sum("did not close" in note for note in record.notes) == 1
    assert path.read_bytes() == bytes(content)
