"""What real bags are made of: one bad part never costs the rest, and is told and counted."""

import sqlite3
from contextlib import closing

import numpy as np
import pytest
import yaml
import zstandard
from foreign_bags import (
    FLOAT,
    STEP,
    T0,
    TEXT,
    number,
    numbers,
    profile,
    text,
    write_db3,
    write_mcap,
    write_metadata,
)

from steering_bringup.bags import BagError, read_bag
from steering_bringup.bags.sources import open_bag

pack = zstandard.ZstdCompressor().compress
GOOD = ("/good", FLOAT, numbers())
SQL_GOOD = ("/good", FLOAT[0], "", numbers())


def read(path):
    """Return {topic: rows} and the notes of a bag."""
    with closing(open_bag(path)) as bag:
        heard: dict[str, list[tuple[int, bytes]]] = {name: [] for name in bag.topics}
        for stamp, name, data in bag.messages(bag.topics):
            heard[name].append((stamp, data))
        assert {name: len(rows) for name, rows in heard.items()} == {
            name: info.count for name, info in bag.topics.items()
        } or bag.notes
        return heard, bag.notes


def assert_good(path, *words, count=20):
    """/good came whole, and the notes say all ``words``; nothing where there are none."""
    heard, notes = read(path)
    assert heard["/good"] == numbers(count)
    assert all(any(word in note for note in notes) for word in words), notes
    assert bool(notes) == bool(words), notes
    trace = read_bag(path, repair_damage=False)
    assert trace["/good"]["data"].tolist() == list(range(count))
    return heard, notes


@pytest.mark.parametrize("packing", ["zstd", "lz4", ""])
@pytest.mark.parametrize("chunks", [True, False])
def test_mcap_of_every_packing(packing, chunks, tmp_path):
    file = write_mcap(tmp_path / "x.mcap", [GOOD], packing, chunks, chunk_size=100)
    assert_good(file)


@pytest.mark.parametrize("version", [1, 2, 3, 4])
def test_sqlite_of_every_version(version, tmp_path):
    file = write_db3(tmp_path / "x.db3", [SQL_GOOD], version, [FLOAT[::2]])
    assert_good(file)
    with closing(open_bag(file)) as bag:
        assert bag.topics["/good"].definition == (FLOAT[2] if version == 4 else "")


def test_a_topic_on_two_channels_is_one(tmp_path):
    rows = numbers()
    halves = [("/good", FLOAT, part) for part in (rows[::2], rows[1::2])]
    commented = (FLOAT[0], FLOAT[1], "# a comment\nfloat64 data 1.0\n")
    file = write_mcap(tmp_path / "x.mcap", [halves[0], ("/good", commented, halves[1][2])])
    assert_good(file)


def test_a_topic_of_two_types_is_two(tmp_path):
    words = [(T0 + 5, text("a"))]
    other = (FLOAT[0], FLOAT[1], "float32 data\n")
    odd = [(T0 + 7, b"\0\1\0\0abcd")]
    file = write_mcap(tmp_path / "x.mcap", [("/good", TEXT, words), GOOD, ("/good", other, odd)])
    heard, _ = assert_good(file)
    assert [rows for name, rows in heard.items() if name != "/good"] == [words, odd]
    assert "/good (std_msgs/msg/String, cdr)" in heard
    notes = read_bag(file, topics={"/good"}).notes
    assert any("1 messages of std_msgs/msg/String are left out" in note for note in notes)


@pytest.mark.parametrize(
    ("schema", "encoding"),
    [
        (None, "cdr"),
        (None, ""),
        (("x.Y", "protobuf", "??"), "protobuf"),
        (("x", "jsonschema", "{}"), "json"),
        (("std_msgs/String", "ros1msg", "string data"), "ros1"),
    ],
)
def test_what_has_no_type_or_other_bytes_keeps_its_own(schema, encoding, tmp_path):
    odd = [(T0, b"\0\1\0\0{}"), (T0 + 1, b"\0\1\0\0")]
    file = write_mcap(tmp_path / "x.mcap", [GOOD, ("/odd", schema, odd, (encoding, {}))])
    heard, _ = assert_good(file)
    assert heard["/odd"] == odd
    assert read_bag(file).opaque["/odd"] == odd


@pytest.mark.parametrize("made", ["folder", "file", "listed"])
@pytest.mark.parametrize("storage", ["mcap", "sqlite"])
def test_messages_that_rosbag2_compressed(storage, made, tmp_path):
    rows = [(stamp, pack(data)) for stamp, data in numbers()]
    folder = tmp_path / "bag"
    if storage == "mcap":
        file = write_mcap(folder / "bag_0.mcap", [("/good", FLOAT, rows)])
    else:
        file = write_db3(folder / "bag_0.db3", [("/good", FLOAT[0], "", rows)])
    if made == "listed":
        write_metadata(folder, [file.name], compression_format="zstd", compression_mode="message")
    assert_good(file if made == "file" else folder)


def test_messages_that_cannot_be_unpacked_are_counted(tmp_path):
    bad = [(T0 + 1, pack(number(1.0))[:-3]), (T0 + 2, pack(number(1.0))[:-3])]
    foreign = [(T0 + k, b"\x04\x22\x4d\x18abc") for k in range(3)]
    channels = [GOOD, ("/bad", FLOAT, bad), ("/lz4", FLOAT, foreign), ("/none", FLOAT, [(T0, b"")])]
    file = write_mcap(tmp_path / "x.mcap", channels)
    words = ("/bad: 2 messages", "/lz4: 3 messages", "/none: 1 messages")
    heard, _ = assert_good(file, *words)
    assert [heard[name] for name in ("/bad", "/lz4", "/none")] == [[], [], []]


@pytest.mark.parametrize("storage", ["mcap", "sqlite"])
def test_files_that_rosbag2_compressed(storage, tmp_path):
    if storage == "mcap":
        plain = write_mcap(tmp_path / "a.file", [GOOD])
    else:
        plain = write_db3(tmp_path / "a.file", [SQL_GOOD])
    folder = tmp_path / "bag"
    folder.mkdir()
    name = f"bag_0.{'mcap' if storage == 'mcap' else 'db3'}"
    (folder / f"{name}.zstd").write_bytes(pack(plain.read_bytes()))
    assert_good(folder)
    assert_good(folder / f"{name}.zstd")
    for listed in (name, f"{name}.zstd"):
        write_metadata(folder, [listed], compression_format="zstd", compression_mode="file")
        assert_good(folder)
    (folder / "metadata.yaml").unlink()
    (folder / name).write_bytes(plain.read_bytes())
    assert_good(folder, "packed: left out")


def test_a_packed_file_that_was_cut_gives_what_is_there(tmp_path):
    rows = numbers(5000)
    plain = write_mcap(tmp_path / "a.mcap", [("/good", FLOAT, rows)], "", chunk_size=1000)
    data = pack(plain.read_bytes())
    (tmp_path / "x.mcap.zstd").write_bytes(data[: len(data) // 2])
    heard, notes = read(tmp_path / "x.mcap.zstd")
    assert 0 < len(heard["/good"]) < 5000
    assert heard["/good"] == rows[: len(heard["/good"])]
    assert any("cut off" in note for note in notes)


def bag_folder(tmp_path, names=("a_0.mcap",)):
    folder = tmp_path / "a"
    rows = numbers()
    for k, name in enumerate(names):
        part = rows[k :: len(names)]
        if name.endswith(".mcap"):
            write_mcap(folder / name, [("/good", FLOAT, part)])
        else:
            write_db3(folder / name, [("/good", FLOAT[0], "", part)])
    return folder


@pytest.mark.parametrize(
    ("listed", "words"),
    [
        (["a_0.mcap"], ()),
        (["a/a_0.mcap"], ()),
        (["/home/me/bags/a/a_0.mcap"], ()),
        (["C:\\bags\\a\\a_0.mcap"], ()),
        (["a_0.mcap", "a_0.mcap"], ()),
        (
            ["a_0.mcap", "a_1.mcap"],
            ("a_1.mcap is listed in metadata.yaml and missing",),
        ),
        (["gone.mcap"], ("gone.mcap is listed",)),
        ([], ()),
    ],
)
def test_the_files_that_metadata_lists(listed, words, tmp_path):
    folder = bag_folder(tmp_path)
    write_metadata(folder, listed)
    assert_good(folder, *words)
    assert_good(folder / "metadata.yaml", *words)


@pytest.mark.parametrize("other", ["a_copy.mcap", "a_0.db3", "b.mcap.zstd"])
def test_files_beside_the_listed_ones_are_told(other, tmp_path):
    folder = bag_folder(tmp_path, ("a_0.mcap",))
    (folder / other).write_bytes((folder / "a_0.mcap").read_bytes())
    (folder / "notes.txt").write_text("a note")
    write_metadata(folder, ["a_0.mcap"])
    assert_good(folder, f"{other} is not listed in metadata.yaml: left out")


@pytest.mark.parametrize(
    ("content", "word"),
    [
        (b"", "it is empty"),
        (b"a: [1, 2\nb: }", "line 2"),
        (b"\xff\xfe\x00", "no text"),
        (b"just words", "has no rosbag2"),
        (b"rosbag2_bagfile_information: [1, 2]", "has no rosbag2"),
        (b"rosbag2_bagfile_information: {relative_file_paths: 3, files: x}", ""),
        (b"rosbag2_bagfile_information: {topics_with_message_count: [3, {}]}", ""),
    ],
)
def test_metadata_that_is_broken(content, word, tmp_path):
    folder = bag_folder(tmp_path)
    (folder / "metadata.yaml").write_bytes(content)
    assert_good(folder, *([word] if word else []))


def test_metadata_that_counts_and_dates_wrongly(tmp_path):
    folder = bag_folder(tmp_path)
    write_metadata(folder, ["a_0.mcap"], count=7, start=T0 + 10**12)
    assert_good(folder, "counts 7 messages, there are 20")


def test_both_storages_in_one_folder(tmp_path):
    assert_good(bag_folder(tmp_path, ("a_0.mcap", "a_1.db3")))


@pytest.mark.parametrize(
    ("name", "content", "word"),
    [
        ("a_9.mcap", b"", "a_9.mcap is left out: is empty"),
        ("a_9.db3", b"", "a_9.db3 is left out: is empty"),
        ("a_9.mcap", b"\x89MCAP0\r\n", "a_9.mcap is not complete"),
        ("a_9.mcap", b"no bag at all", "no MCAP and no SQLite"),
        ("a_9.db3", b"SQLite format 3\0" + b"x" * 200, "a_9.db3 is left out"),
        ("a_9.mcap.zstd", b"\x28\xb5\x2f\xfdxxxxxxxxxx", "a_9.mcap.zstd: it is damaged"),
    ],
)
@pytest.mark.parametrize("listed", [True, False])
def test_a_bad_last_file_costs_no_other(name, content, word, listed, tmp_path):
    folder = bag_folder(tmp_path, ("a_0.mcap", "a_1.mcap"))
    (folder / name).write_bytes(content)
    if listed:
        write_metadata(folder, ["a_0.mcap", "a_1.mcap", name])
    assert_good(folder, word)


def test_the_cut_last_file_of_several(tmp_path):
    folder = bag_folder(tmp_path)
    more = [("/good", FLOAT, numbers(500, T0 + 20 * STEP))]
    data = write_mcap(folder / "a_1.mcap", more, "", chunk_size=1000).read_bytes()
    (folder / "a_1.mcap").write_bytes(data[: len(data) // 2])
    heard, notes = read(folder)
    stamps = [stamp for stamp, _ in heard["/good"]]
    assert 20 < len(stamps) < 520
    assert stamps == [T0 + k * STEP for k in range(len(stamps))]
    assert any("a_1.mcap is not complete" in note for note in notes)


def test_a_page_in_the_middle_of_a_database(tmp_path):
    rows = numbers(4000)
    file = write_db3(tmp_path / "x.db3", [("/good", FLOAT[0], "", rows)])
    data = bytearray(file.read_bytes())
    middle = data.index(number(2000.0)) // 4096 * 4096
    data[middle : middle + 4096] = b"\xee" * 4096
    file.write_bytes(data)
    heard, notes = read(file)
    assert set(heard["/good"]) < set(rows)
    assert 3700 < len(heard["/good"]) < 4000
    assert {rows[0], rows[-1]} <= set(heard["/good"])
    assert any("damaged" in note for note in notes)


def test_rows_that_are_no_messages_are_counted(tmp_path):
    file = write_db3(tmp_path / "x.db3", [SQL_GOOD])
    with closing(sqlite3.connect(file)) as connection:
        for row in ((1, "noon", b"x"), (1, T0, "text"), (77, T0, b"\0\1\0\0")):
            connection.execute("INSERT INTO messages VALUES (NULL, ?, ?, ?)", row)
        connection.commit()
    assert_good(file, "3 rows without a time, content or known topic")


def test_a_channel_number_that_is_used_twice(tmp_path):
    """Two files put behind each other by hand."""
    one = write_mcap(tmp_path / "a.mcap", [GOOD], "", chunks=False).read_bytes()
    two = write_mcap(tmp_path / "b.mcap", [("/more", FLOAT, numbers(5))], "", chunks=False)
    footer = one.rindex(b"\x0f\x04\0\0\0\0\0\0\0")  # the end of the data
    (tmp_path / "x.mcap").write_bytes(one[:footer] + two.read_bytes()[8:])
    heard, _ = read(tmp_path / "x.mcap")
    assert (len(heard["/good"]), len(heard["/more"])) == (20, 5)


def test_messages_out_of_order_come_in_order(tmp_path):
    rows = [(T0 + k * STEP, number(k)) for k in (3, 1, 2, 2, 0)]
    file = tmp_path / "x.db3"
    write_db3(file, [("/good", FLOAT[0], "", rows)])
    heard, _ = read(file)
    assert [stamp for stamp, _ in heard["/good"]] == [T0 + k * STEP for k in (0, 1, 2, 2, 3)]


@pytest.mark.parametrize("odd", [0, -5, 1, (1 << 63) - 1])
@pytest.mark.parametrize("storage", ["mcap", "sqlite"])
def test_a_stamp_far_from_the_others_is_a_stretch_of_its_own(storage, odd, tmp_path):
    rows = sorted([*numbers(), (odd, number(-1.0))])
    if storage == "mcap":
        rows = [(stamp % (1 << 64), data) for stamp, data in rows]
        file = write_mcap(tmp_path / "x.mcap", [("/good", FLOAT, rows)])
    else:
        file = write_db3(tmp_path / "x.db3", [("/good", FLOAT[0], "", rows)])
    with closing(open_bag(file)) as bag:
        assert sorted(bag.spans) == sorted([(odd, odd), (T0, T0 + 19 * STEP)])
        assert len(list(bag.messages(bag.topics))) in (20, 21)


@pytest.mark.parametrize(
    ("profiles", "kept"),
    [
        ([profile()], (True, 1)),
        ([profile(1, 3, 1)], (True, 3)),
        ([profile("1", 3, "1")], (True, 3)),
        ([profile("TRANSIENT_LOCAL", 0, 3)], (True, 0)),
        ([profile(), profile()], (True, 0)),
        ([profile(), profile("volatile")], (True, 1)),
        ([profile("volatile")], (False, 0)),
        ([profile(2)], (False, 0)),
        ([], (False, 0)),
        (["nonsense", {"durability": "transient_local"}], (True, 0)),
    ],
)
@pytest.mark.parametrize("told_by", ["channel", "table", "list", "text"])
def test_what_publishers_kept(profiles, kept, told_by, tmp_path):
    words, folder = yaml.safe_dump(profiles), tmp_path / "bag"
    if told_by == "table":
        write_db3(folder / "a.db3", [("/good", FLOAT[0], words, numbers())])
    else:
        told = {"offered_qos_profiles": words if told_by == "channel" else ""}
        write_mcap(folder / "a.mcap", [(*GOOD, ("cdr", told))])
    if told_by in ("list", "text"):
        write_metadata(
            folder, ["a.mcap"], [("/good", FLOAT[0], profiles if told_by == "list" else words)]
        )
    with closing(open_bag(folder)) as bag:
        info = bag.topics["/good"]
        assert (info.durable, info.depth) == kept
        assert not bag.notes


@pytest.mark.parametrize("name", ["/tf_static", "/car/tf_static", "/robot_description"])
def test_names_that_are_kept_by_convention(name, tmp_path):
    with closing(open_bag(write_mcap(tmp_path / "x.mcap", [(name, FLOAT, numbers())]))) as bag:
        assert bag.topics[name].durable


@pytest.mark.parametrize(
    ("make", "text"),
    [
        (lambda p: p.mkdir(), "is no bag"),
        (lambda p: p.mkdir() or (p / "a.bag").write_bytes(b"#ROSBAG V2.0\n"), "ROS 1"),
        (lambda p: write_mcap(p / "run" / "a.mcap", [GOOD]), "its folder 'run' does"),
        (lambda p: write_mcap(p, []), "holds no message"),
        (lambda p: write_db3(p, [("/a", FLOAT[0], "", [])]), "holds no message"),
        (lambda p: p.write_bytes(b""), "is empty"),
        (lambda p: p.write_bytes(b"#ROSBAG V2.0\nxx"), "ROS 1"),
        (lambda p: sqlite3.connect(p).execute("CREATE TABLE a(b)").close(), "table of topics"),
    ],
)
def test_what_holds_nothing_is_one_line(make, text, tmp_path):
    make(tmp_path / "x")
    with pytest.raises(BagError, match=text) as raised:
        open_bag(tmp_path / "x")
    assert "\n" not in str(raised.value)


@pytest.mark.parametrize("storage", ["mcap", "loose", "sqlite"])
def test_damage_anywhere_gives_messages_or_one_line(storage, tmp_path):
    rows, file, random = numbers(300), tmp_path / "x.bag_file", np.random.default_rng(5)
    if storage == "sqlite":
        write_db3(file, [("/good", FLOAT[0], "", rows)], 4, [FLOAT[::2]])
    else:
        write_mcap(file, [("/good", FLOAT, rows)], "", storage == "mcap", chunk_size=2000)
    whole = file.read_bytes()
    for _ in range(25):
        data = bytearray(whole)
        at, length = int(random.integers(len(data))), int(random.integers(1, 3000))
        data[at : at + length] = random.bytes(int(random.integers(0, 2)) * length)
        file.write_bytes(data)
        try:
            heard, _ = read(file)
        except BagError as error:
            assert len(str(error).splitlines()) == 1  # noqa: PT017  (either is right)
        else:
            assert heard.get("/good", rows)
