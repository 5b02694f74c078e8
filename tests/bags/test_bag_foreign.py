"""Bags that other tools wrote, and types that this software does not know."""

from typing import Any

import numpy as np
import pytest
import yaml
from foreign_bags import FLOAT, numbers, profile, write_mcap
from rosbags.rosbag2 import StoragePlugin, Writer
from rosbags.typesys import Stores, get_types_from_msg, get_typestore

from steering_bringup.bags import BagError, read_bag, repair
from steering_bringup.bags.encode import encode

GAUGE = "std_msgs/Header header\nfloat32[3] strain\nint16 count\nbool fine\n"


@pytest.mark.parametrize("plugin", [StoragePlugin.MCAP, StoragePlugin.SQLITE3])
def test_a_foreign_bag_with_its_own_type_is_read(tmp_path, plugin):
    store = get_typestore(Stores.ROS2_JAZZY)
    store.register(get_types_from_msg(GAUGE, "rig_msgs/msg/Gauge"))
    header = store.types["std_msgs/msg/Header"]
    time = store.types["builtin_interfaces/msg/Time"]
    gauge = store.types["rig_msgs/msg/Gauge"]
    with Writer(tmp_path / "rig", version=9, storage_plugin=plugin) as writer:
        connection = writer.add_connection("/gauge", "rig_msgs/msg/Gauge", typestore=store)
        for k in range(50):
            stamp = time(sec=3, nanosec=k * 1000)
            values = np.array([k, k + 0.5, -k], np.float32)
            message = gauge(header=header(stamp, "rig"), strain=values, count=-k, fine=k % 2 == 0)
            data = store.serialize_cdr(message, "rig_msgs/msg/Gauge")
            writer.write(connection, 10**9 + k, data)
    trace = read_bag(tmp_path / "rig")
    rows = trace["/gauge"]
    assert trace.complete
    assert np.array_equal(rows["stamp"], 3 * 10**9 + 1000 * np.arange(50))
    assert np.array_equal(rows["strain"][:, 1], np.arange(50) + 0.5)
    assert np.array_equal(rows["count"], -np.arange(50))
    assert rows["fine"].sum() == 25


def test_a_definition_that_cannot_be_read_leaves_bytes(tmp_path):
    with Writer(tmp_path / "odd", version=9, storage_plugin=StoragePlugin.MCAP) as writer:
        connection = writer.add_connection("/odd", "odd/msg/Odd", msgdef="???", rihs01="RIHS01_0")
        writer.write(connection, 7, b"\0\1\0\0abcdefgh")
    trace = read_bag(tmp_path / "odd")
    assert trace.opaque["/odd"] == [(7, b"\0\1\0\0abcdefgh")]


def test_a_broken_database_is_named(tmp_path):
    folder = tmp_path / "broken"
    folder.mkdir()
    (folder / "broken_0.db3").write_bytes(b"no database")
    with pytest.raises(BagError, match="broken"):
        read_bag(folder)


@pytest.mark.parametrize("kind", ["kept", "typeless", "two channels"])
def test_reading_another_recorder_s_file_leaves_it_as_it_is(kind, tmp_path):
    """What its channels tell of publishers, and channels of their own, would be lost."""
    told = ("cdr", {"offered_qos_profiles": yaml.safe_dump([profile()])})
    channels: dict[str, list[tuple[Any, ...]]] = {
        "kept": [("/a", FLOAT, numbers(), told)],
        "typeless": [("/a", FLOAT, numbers()), ("/b", None, numbers())],
        "two channels": [("/a", FLOAT, numbers()[:10]), ("/a", FLOAT, numbers()[10:])],
    }
    file = write_mcap(tmp_path / "rig" / "rig_0.mcap", channels[kind], "")
    before = file.read_bytes()
    assert len(read_bag(file.parent)["/a"]) == 20
    assert [f.name for f in file.parent.iterdir()] == ["rig_0.mcap"]
    assert file.read_bytes() == before
    if kind == "typeless":
        with pytest.raises(BagError, match="/b has no type"):
            repair(file.parent)
        assert file.read_bytes() == before


def test_encoding_agrees_with_the_lock_steps_own_layout():
    """Two independent ways from .msg text to bytes."""
    topics = pytest.importorskip("steering_lockstep.topics")
    random = np.random.default_rng(3)
    ticks = np.arange(2500, 2600)
    for name, entry in topics.TABLE.items():
        wire = topics.wire(name) if entry.type_name.startswith("steering_msgs/") else None
        if wire is None:
            continue
        columns = random.normal(size=(len(ticks), len(wire.fields)))
        whole = [wire.dtype[field].kind != "f" for field in wire.fields]
        columns[:, whole] = random.integers(0, 2, size=(len(ticks), sum(whole)))
        theirs = wire.from_columns(ticks, columns).view(np.uint8).reshape(len(ticks), -1)
        ours = encode(
            entry.type_name.replace("/", "/msg/"),
            ticks * 1_000_000,
            {"tick": ticks, **dict(zip(wire.fields, columns.T, strict=True))},
            frame_id=entry.strings["header.frame_id"],
        )
        assert np.array_equal(ours, theirs), name
