"""What is written comes back, to the bit, by our reader and by rosbags' own."""

from pathlib import Path
from typing import Any

import numpy as np
import pytest
import yaml
from rosbags.highlevel import AnyReader

from steering_bringup.bags import BagError, BagWriter, first_difference, note_in_bag, read_bag
from steering_bringup.bags.definitions import definition
from steering_bringup.bags.encode import encode


def test_every_byte_comes_back(make_bag, random_ticks, topics):
    stamps, payloads = random_ticks(200)
    trace = read_bag(make_bag())
    assert trace.complete
    assert trace.notes == []
    assert trace.types == topics
    for topic, rows in payloads.items():
        assert np.array_equal(trace.payloads[topic], rows)
        assert np.array_equal(trace[topic]["stamp"], stamps)
        assert np.array_equal(trace[topic]["tick"], np.arange(200))


def test_rosbags_reads_the_same_values(make_bag):
    path = make_bag(count=60)
    trace = read_bag(path)
    angles = []
    with AnyReader([path]) as reader:
        assert reader.message_count == 180
        for connection, stamp, data in reader.messages():
            if connection.topic == "/steering/torque":
                message: Any = reader.deserialize(data, connection.msgtype)
                assert stamp == message.tick * 1_000_000
                angles.append(message.steering_wheel_angle)
    assert np.array_equal(trace.column("/steering/torque", "steering_wheel_angle"), angles)


@pytest.mark.parametrize("options", [{"compress": True}, {"chunk_bytes": 2000}, {"per_chunk": 7}])
def test_chunks_and_compression_change_nothing(make_bag, options):
    plain = read_bag(make_bag("plain"))
    other = read_bag(make_bag("other", **options))
    assert first_difference(plain, other) is None


def test_a_bag_says_which_distribution_its_messages_are_of(make_bag):
    """In metadata.yaml, and in the copy of it that the file carries."""
    path = make_bag()
    information = yaml.safe_load((path / "metadata.yaml").read_text())
    assert information["rosbag2_bagfile_information"]["ros_distro"] == "jazzy"
    assert b"ros_distro: jazzy" in (path / "run.mcap").read_bytes()
    assert [f.name for f in sorted(path.iterdir())] == ["metadata.yaml", "run.mcap", "run.yaml"]


def test_metadata_say_when_a_run_was_started(tmp_path, topics):
    run = {"started": "2026-02-03T04:05:06+00:00"}
    with BagWriter(tmp_path / "run", topics, run):
        pass
    information = yaml.safe_load((tmp_path / "run" / "metadata.yaml").read_text())
    custom = information["rosbag2_bagfile_information"]["custom_data"]
    assert custom["steering_started"] == run["started"]


def test_the_same_ticks_compress_to_the_same_bytes(make_bag, random_ticks, topics, tmp_path):
    stamps, payloads = random_ticks(500)
    files = []
    for name in ("a", "b"):
        with BagWriter(tmp_path / name / "run", topics, compress=True) as writer:
            writer.write_block(stamps, payloads)
        files.append((tmp_path / name / "run" / "run.mcap").read_bytes())
    assert files[0] == files[1]
    plain = tmp_path / "plain"
    with BagWriter(plain, topics) as writer:
        writer.write_block(stamps, payloads)
    assert len(files[0]) < len((plain / "plain.mcap").read_bytes())


def test_a_run_that_was_broken_off_says_so(tmp_path, topics, random_ticks):
    stamps, payloads = random_ticks(40)
    with BagWriter(tmp_path / "run", topics) as writer:
        writer.write_block(stamps, payloads)
        writer.broken_off(40, 5000)
    trace = read_bag(tmp_path / "run")
    assert trace.complete
    assert "the run was broken off after 40 of 5000 ticks" in trace.notes
    note_in_bag(tmp_path / "run", {"broken_off": "SIGINT"})
    assert "broken off after 40 of 5000 ticks: SIGINT" in " ".join(read_bag(tmp_path / "run").notes)


def test_blocks_equal_single_messages(make_bag, tmp_path, random_ticks, topics):
    stamps, payloads = random_ticks(200)
    with BagWriter(tmp_path / "blocks", topics, chunk_bytes=5000) as writer:
        writer.write_block(stamps, payloads)
    blocks = read_bag(tmp_path / "blocks")
    assert first_difference(read_bag(make_bag()), blocks) is None
    with AnyReader([tmp_path / "blocks"]) as reader:
        order = [(t, c.topic) for c, t, _ in reader.messages()]
    assert order == [(t, topic) for t in stamps.tolist() for topic in topics]


def test_metadata_is_there_before_the_first_message_and_in_the_closed_bag(tmp_path, topics):
    run = {"scenario": {"name": "on_centre"}, "overrides": {"mechanics.rack_mass": 30.0}}
    with BagWriter(tmp_path / "run", topics, run):
        assert yaml.safe_load((tmp_path / "run" / "run.yaml").read_text()) == run
    (tmp_path / "run" / "run.yaml").unlink()
    information = yaml.safe_load((tmp_path / "run" / "metadata.yaml").read_text())
    custom = information["rosbag2_bagfile_information"]["custom_data"]
    assert yaml.safe_load(custom["steering_run"]) == run
    assert custom["steering_outcome"] == "complete"


def test_definitions_in_the_bag_keep_units_and_signs():
    text, _ = definition("steering_msgs/msg/RackForce")
    assert "positive opposes positive rack displacement" in text
    assert "MSG: std_msgs/Header" in text


def test_standard_messages_of_fixed_size_are_columns(tmp_path):
    stamps = np.arange(5, dtype=np.int64) * 10_000_000
    values = {"twist.twist.linear.x": 19.4, "pose.pose.position.y": np.arange(5.0)}
    rows = encode("nav_msgs/msg/Odometry", stamps, values, frame_id="odom")
    with BagWriter(tmp_path / "run", {"/vehicle/odometry": "nav_msgs/msg/Odometry"}) as writer:
        writer.write_block(stamps, {"/vehicle/odometry": rows})
    trace = read_bag(tmp_path / "run")
    assert np.array_equal(trace.column("/vehicle/odometry", "pose.pose.position.y"), np.arange(5.0))
    assert trace["/vehicle/odometry"]["twist.covariance"].shape == (5, 36)


def test_messages_of_varying_size_are_kept_as_bytes(tmp_path):
    with BagWriter(tmp_path / "run", {"/diagnostics": "diagnostic_msgs/msg/DiagnosticArray"}) as w:
        w.write("/diagnostics", 5, b"\0\1\0\0abcd")
        w.write("/diagnostics", 6, b"\0\1\0\0abcdefgh")
    assert [t for t, _ in read_bag(tmp_path / "run").opaque["/diagnostics"]] == [5, 6]


def test_missing_ticks_are_reported(tmp_path, random_ticks, topics):
    stamps, payloads = random_ticks(100)
    keep = np.delete(np.arange(100), [40, 41, 70])
    with BagWriter(tmp_path / "run", topics) as writer:
        writer.write_block(stamps[keep], {t: p[keep] for t, p in payloads.items()})
    trace = read_bag(tmp_path / "run")
    gaps = [(g.after, g.before, g.missing) for g in trace.gaps if g.topic == "/driver/torque"]
    assert gaps == [(39, 42, 2), (69, 71, 1)]
    assert any("2 ticks missing between 39 and 42" in note for note in trace.notes)


@pytest.mark.parametrize("kind", ["missing", "empty_folder", "no_mcap"])
def test_what_is_no_bag_is_refused_by_name(tmp_path: Path, kind):
    path = tmp_path / "thing"
    if kind == "empty_folder":
        path.mkdir()
    elif kind == "no_mcap":
        path = tmp_path / "thing.mcap"
        path.write_bytes(b"something else entirely")
    with pytest.raises(BagError, match="thing"):
        read_bag(path)


def test_unknown_topic_or_field_names_what_there_is(make_bag):
    trace = read_bag(make_bag(count=5))
    with pytest.raises(BagError, match="/steering/torque"):
        trace["/steering/torqe"]
    with pytest.raises(BagError, match="reference_angle"):
        trace.column("/driver/torque", "angle")
