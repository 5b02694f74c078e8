"""Messages out of bags of every origin, whole and cut off, in order of time."""

import sqlite3
from contextlib import closing

import numpy as np
import pytest
from rosbags.rosbag2 import CompressionFormat, CompressionMode, StoragePlugin, Writer
from rosbags.typesys import Stores, get_typestore

from steering_bringup.bags import BagError, BagWriter
from steering_bringup.bags.encode import encode
from steering_bringup.bags.sources import open_bag as open_source
from steering_bringup.errors import BenchError
from steering_bringup.playback.choice import chosen_topics, parse_remaps

STORE = get_typestore(Stores.ROS2_JAZZY)
TEXT = "std_msgs/msg/String"
PLUGINS = {"mcap": StoragePlugin.MCAP, "sqlite": StoragePlugin.SQLITE3}
COUNT = 400


def expected(count=COUNT):
    """Two topics, the second at a fifth of the rate; sizes differ from message to message."""
    stamps = [10**9 + k * 1_000_000 for k in range(count)]
    return [
        (stamp, topic, cdr(f"{topic} {k} " + "." * (k % 50)))
        for k, stamp in enumerate(stamps)
        for topic in (("/a", "/b") if k % 5 == 0 else ("/a",))
    ]


def cdr(text):
    message = STORE.types[TEXT](data=text)
    return bytes(STORE.serialize_cdr(message, TEXT))


def write(folder, plugin, rows, compress=None):
    with_compression = Writer(folder, version=9, storage_plugin=PLUGINS[plugin])
    if compress:
        with_compression.set_compression(compress, CompressionFormat.ZSTD)
    with with_compression as writer:
        made = {t: writer.add_connection(t, TEXT, typestore=STORE) for t in ("/a", "/b")}
        for stamp, topic, data in rows:
            writer.write(made[topic], stamp, data)
    return folder


def everything(path):
    with closing(open_source(path)) as source:
        return source, list(source.messages(source.topics, source.start, source.end + 1))


@pytest.mark.parametrize("plugin", PLUGINS)
def test_every_message_comes_in_order_of_time(plugin, tmp_path):
    rows = expected()
    shuffled = [rows[k] for k in np.random.default_rng(1).permutation(len(rows))]
    source, messages = everything(write(tmp_path / "bag", plugin, shuffled))
    assert sorted(messages) == sorted(rows)
    assert [m[0] for m in messages] == [r[0] for r in rows]
    assert source.topics["/b"].count == COUNT // 5
    assert (source.start, source.end) == (rows[0][0], rows[-1][0])
    assert source.notes == []


@pytest.mark.parametrize("plugin", PLUGINS)
def test_a_part_of_the_time_and_of_the_topics(plugin, tmp_path):
    first, last = 10**9 + 50_000_000, 10**9 + 60_000_000
    with closing(open_source(write(tmp_path / "bag", plugin, expected()))) as source:
        chosen = list(source.messages(["/b"], first, last))
    assert [m[0] for m in chosen] == [first, first + 5_000_000]
    assert {m[1] for m in chosen} == {"/b"}


@pytest.mark.parametrize("plugin", PLUGINS)
def test_a_single_file_without_its_folder(plugin, tmp_path):
    folder = write(tmp_path / "bag", plugin, expected())
    (file,) = (f for f in folder.iterdir() if f.suffix in (".mcap", ".db3"))
    assert everything(file)[1] == expected()


@pytest.mark.parametrize(
    ("plugin", "mode"),
    [
        ("sqlite", CompressionMode.FILE),
        ("sqlite", CompressionMode.MESSAGE),
        ("mcap", CompressionMode.STORAGE),
    ],
)
def test_compressed_bags(plugin, mode, tmp_path):
    assert everything(write(tmp_path / "bag", plugin, expected(), mode))[1] == expected()


@pytest.mark.parametrize("plugin", PLUGINS)
def test_a_bag_in_several_files(plugin, tmp_path):
    """Other tools begin a new file now and then; a tenth file comes after the ninth."""
    rows, folder = expected(), tmp_path / "bag"
    folder.mkdir()
    for part in range(11):
        made = write(tmp_path / f"part{part}", plugin, rows[part * 40 : (part + 1) * 40])
        (file,) = (f for f in made.iterdir() if f.suffix in (".mcap", ".db3"))
        file.rename(folder / f"bag_{part}{file.suffix}")
    assert everything(folder)[1] == rows[:440]


@pytest.mark.parametrize("plugin", PLUGINS)
@pytest.mark.parametrize("share", [0.5, 0.75])
def test_a_cut_off_bag_is_read_as_far_as_it_goes(plugin, share, tmp_path):
    rows = expected(4000)
    folder = write(tmp_path / "bag", plugin, rows)
    (file,) = (f for f in folder.iterdir() if f.suffix in (".mcap", ".db3"))
    data = file.read_bytes()
    file.write_bytes(data[: int(len(data) * share)])
    (folder / "metadata.yaml").unlink()
    source, messages = everything(folder)
    assert 100 < len(messages) < len(rows)
    assert set(messages) <= set(rows)
    assert any(word in source.notes[0] for word in ("not complete", "damaged"))
    assert [m[0] for m in messages] == sorted(m[0] for m in messages)


def test_our_own_bag_cut_off_in_a_run_says_so(tmp_path):
    ticks = np.arange(1000)
    topics = {"/driver/torque": "steering_msgs/msg/DriverTorque"}
    payloads = encode(topics["/driver/torque"], ticks * 10**6, {"tick": ticks}, "steering_wheel")
    with BagWriter(tmp_path / "bag", topics) as writer:
        for k in ticks.tolist():
            writer.write("/driver/torque", k * 10**6, payloads[k].tobytes())
            if k % 100 == 99:
                writer.flush()
    (file,) = (tmp_path / "bag").glob("*.mcap")
    file.write_bytes(file.read_bytes()[: file.stat().st_size // 2])
    source, messages = everything(tmp_path / "bag")
    assert "steer recover" in source.notes[0]
    assert [data for _, _, data in messages] == [p.tobytes() for p in payloads[: len(messages)]]
    assert len(messages) > 300


def test_a_log_that_a_crash_left_beside_a_database_is_read(tmp_path):
    folder = write(tmp_path / "bag", "sqlite", expected(50))
    (file,) = folder.glob("*.db3")
    writer = sqlite3.connect(file)
    writer.execute("PRAGMA journal_mode=WAL")
    (topic,) = writer.execute("SELECT id FROM topics WHERE name = '/a'").fetchone()
    row = (topic, 3 * 10**9, cdr("last"))
    writer.execute("INSERT INTO messages(topic_id, timestamp, data) VALUES (?, ?, ?)", row)
    writer.commit()
    assert list(folder.glob("*-wal"))
    assert everything(folder)[1][-1] == (3 * 10**9, "/a", cdr("last"))
    writer.close()


@pytest.mark.parametrize(
    ("name", "text"), [("nothing", "no bag"), ("old.bag", "ROS 1"), ("bad.db3", "cannot be read")]
)
def test_what_is_no_bag_is_named(name, text, tmp_path):
    if name != "nothing":
        (tmp_path / name).write_bytes(b"no bag at all" * 100)
    with pytest.raises(BagError, match=text):
        open_source(tmp_path / name)


def test_an_empty_bag_is_named(tmp_path):
    with pytest.raises(BagError, match="holds no message"):
        open_source(write(tmp_path / "bag", "sqlite", []))


def test_topics_are_chosen_in_the_bag_s_order():
    known = ("/a", "/b", "/c")
    assert chosen_topics(known, (), ("/b",)) == ("/a", "/c")
    assert chosen_topics(known, ("/c", "/a"), ()) == ("/a", "/c")
    with pytest.raises(BenchError, match="'/d'"):
        chosen_topics(known, ("/d",), ())


def test_remaps():
    assert parse_remaps(["/a:=/x"], ("/a", "/b")) == {"/a": "/x", "/b": "/b"}
    assert parse_remaps(["/a:=/b", "/b:=/a"], ("/a", "/b")) == {"/a": "/b", "/b": "/a"}


@pytest.mark.parametrize(
    ("text", "reason"),
    [("/a", "OLD:=NEW"), ("/a:=x", "OLD:=NEW"), ("/q:=/x", "'/q'"), ("/a:=/b", "would both")],
)
def test_bad_remaps(text, reason):
    with pytest.raises(BenchError, match=reason):
        parse_remaps([text], ("/a", "/b"))
