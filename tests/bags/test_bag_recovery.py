"""A bag that was cut off anywhere gives back every whole message before the cut."""

import os
import re
import signal
import subprocess
import sys
import time
import zlib
from pathlib import Path

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from mcap.reader import make_reader
from mcap.records import DataEnd, Footer
from mcap.stream_reader import StreamReader
from rosbags.highlevel import AnyReader

from steering_bringup.bags import BagError, BagWriter, first_difference, read_bag, repair

WRITER = """
import sys, time
from pathlib import Path
sys.path.insert(0, {here!r})
from conftest import TOPICS, payloads_of
from steering_bringup.bags import BagWriter
stamps, payloads = payloads_of(20000)
with BagWriter({path!r}, TOPICS, {{"scenario": {{"name": "killed"}}}}, flush_seconds=0.05) as w:
    for k, stamp in enumerate(stamps.tolist()):
        for topic, rows in payloads.items():
            w.write(topic, stamp, rows[k].tobytes())
        if k % 10 == 0:
            print(k, flush=True)
            time.sleep(0.001)
"""


def _cut(path: Path, size: int) -> None:
    """Leave what a killed writer would: the first bytes and no metadata.yaml."""
    (path / "metadata.yaml").unlink(missing_ok=True)
    with next(path.glob("*.mcap")).open("r+b") as file:
        file.truncate(size)


def _whole_messages_before(data: bytes, cut: int) -> int:
    """Second route: message records are found by their own bytes, not by walking the file."""
    head = re.compile(rb"\x05(.{8})(.{2})\x00{4}(.{8})\3", re.DOTALL)
    ends = [
        found.start() + 9 + int.from_bytes(found[1], "little")
        for found in head.finditer(data)
        if int.from_bytes(found[1], "little") < 200
    ]
    return sum(end <= cut for end in ends)


@pytest.fixture
def whole(make_bag):
    """A complete bag's file and its trace."""
    path = make_bag("original", count=120, per_chunk=25)
    return path / "original.mcap", read_bag(path)


@settings(
    max_examples=60, deadline=None, suppress_health_check=[HealthCheck.function_scoped_fixture]
)
@given(number=st.integers(0, 2**32))
def test_every_whole_message_before_a_cut_is_recovered(tmp_path, whole, number):
    content, original = whole[0].read_bytes(), whole[1]
    cut = number % len(content)
    path = tmp_path / f"cut_{cut}"
    path.mkdir(exist_ok=True)
    for old in path.iterdir():
        old.unlink()
    (path / f"{path.name}.mcap").write_bytes(content[:cut])
    expected = _whole_messages_before(content, cut)
    if not expected:
        with pytest.raises(BagError, match=path.name):
            read_bag(path)
        return
    trace = read_bag(path)
    assert trace.message_count == expected
    assert any("recovered" in note for note in trace.notes)
    for topic, rows in trace.payloads.items():
        assert np.array_equal(rows, original.payloads[topic][: len(rows)])
    assert (path / f"{path.name}.mcap.damaged").read_bytes() == content[:cut]
    again = read_bag(path)
    assert again.complete
    assert again.outcome.startswith("recovered")
    assert first_difference(trace, again) is None


def test_other_readers_open_a_repaired_bag(make_bag):
    path = make_bag(count=100)
    size = (path / "run.mcap").stat().st_size
    _cut(path, size // 2)
    report = repair(path)
    assert str(report.messages) in str(report)
    with AnyReader([path]) as reader:
        assert reader.message_count == report.messages
        assert len(list(reader.messages())) == report.messages
    with (path / "run.mcap").open("rb") as file:
        messages = make_reader(file, validate_crcs=True).iter_messages()
        assert len(list(messages)) == report.messages


def test_the_run_of_a_cut_bag_is_known(make_bag):
    path = make_bag()
    _cut(path, (path / "run.mcap").stat().st_size - 100)
    assert read_bag(path).run["scenario"] == {"name": "test"}
    assert read_bag(path).run["parameters"] == {"mechanics.rack_mass": 24.0}


@pytest.mark.parametrize("compress", [False, True])
def test_a_damaged_chunk_is_left_out_and_said(make_bag, compress):
    path = make_bag(count=200, per_chunk=50, compress=compress)
    file = path / "run.mcap"
    content = bytearray(file.read_bytes())
    content[len(content) // 3] ^= 0xFF
    file.write_bytes(content)
    trace = read_bag(path)
    assert trace.message_count == 450
    assert any("damaged" in note for note in trace.notes)
    assert [g.missing for g in trace.gaps if g.topic == "/driver/torque"] == [50]


def test_reading_only_changes_nothing(make_bag):
    path = make_bag()
    _cut(path, 5000)
    before = {f.name: f.read_bytes() for f in path.iterdir()}
    assert not read_bag(path, repair_damage=False).complete
    assert {f.name: f.read_bytes() for f in path.iterdir()} == before


def test_a_bag_that_is_being_written_is_read_but_not_repaired(tmp_path, topics, random_ticks):
    stamps, payloads = random_ticks(30)
    with BagWriter(tmp_path / "run", topics) as writer:
        writer.write_block(stamps, payloads)
        writer.flush()
        trace = read_bag(tmp_path / "run")
        assert trace.message_count == 90
        assert "the bag is still being written" in trace.notes
        with pytest.raises(BagError, match="still being written"):
            repair(tmp_path / "run")
    assert read_bag(tmp_path / "run").complete


def test_a_complete_bag_is_not_repaired(make_bag):
    with pytest.raises(BagError, match="nothing to repair"):
        repair(make_bag(count=5))


def test_a_failed_repair_leaves_the_bag_as_it_was(make_bag, monkeypatch):
    path = make_bag()
    _cut(path, 9000)
    before = {f.name: f.read_bytes() for f in path.iterdir()}

    def full(*_: object) -> int:
        raise OSError(28, "No space left on device")

    monkeypatch.setattr(os, "write", full)
    with pytest.raises(BagError, match="No space left"):
        repair(path)
    assert {f.name: f.read_bytes() for f in path.iterdir()} == before


def test_sigkill_loses_at_most_the_flush_interval(tmp_path):
    """The writer is killed in mid-run; the next reader gets everything flushed by then."""
    path = tmp_path / "killed"
    code = WRITER.format(here=str(Path(__file__).parent), path=str(path))
    environment = {**os.environ, "PYTHONPATH": os.pathsep.join(sys.path)}
    process = subprocess.Popen(
        [sys.executable, "-c", code], stdout=subprocess.PIPE, text=True, env=environment
    )
    assert process.stdout is not None
    last = int(process.stdout.readline())
    started = time.monotonic()
    for line in process.stdout:
        last = int(line)
        if time.monotonic() - started > 0.5:
            break
    elapsed = time.monotonic() - started
    process.send_signal(signal.SIGKILL)
    last = max([last, *(int(line) for line in process.stdout if line.endswith("\n"))])
    process.wait(10)
    process.stdout.close()
    trace = read_bag(path)
    assert trace.run["scenario"]["name"] == "killed"
    assert trace.last_tick is not None
    # Twice the interval (0.05 s), plus the pace of a busy machine.
    assert last - trace.last_tick <= 4 * 0.05 / elapsed * last + 20
    assert trace.gaps == []
    assert read_bag(path).complete


@settings(
    max_examples=150, deadline=None, suppress_health_check=[HealthCheck.function_scoped_fixture]
)
@given(number=st.integers(0, 2**32), bits=st.integers(1, 255), count=st.integers(1, 12))
def test_damaged_bytes_never_give_wrong_numbers(tmp_path, whole, number, bits, count):
    """Whatever is returned was recorded; anything else is an error or a note."""
    content, original = bytearray(whole[0].read_bytes()), whole[1]
    start = number % len(content)
    for k in range(start, min(start + count, len(content))):
        content[k] ^= bits
    file = tmp_path / "damaged.mcap"
    file.write_bytes(content)
    try:
        trace = read_bag(file, repair_damage=False)
    except BagError:
        return
    for topic, rows in trace.payloads.items():
        known = {row.tobytes() for row in original.payloads.get(topic, np.empty((0, 1), "u1"))}
        if known:
            assert all(row.tobytes() in known for row in rows)


def test_a_chunk_that_is_no_longer_known_as_one_is_missed(make_bag):
    """The file's own statistics tell how many messages there were."""
    path = make_bag(count=100, per_chunk=50)
    file = path / "run.mcap"
    content = bytearray(file.read_bytes())
    sizes = range(8_000, 20_000)
    chunks = [
        k
        for k in range(len(content) - 9)
        if content[k] == 0x06 and int.from_bytes(content[k + 1 : k + 9], "little") in sizes
    ]
    content[chunks[-1]] = 0x80
    file.write_bytes(content)
    trace = read_bag(path, repair_damage=False)
    assert not trace.complete
    assert "300 messages were recorded" in trace.notes[0]
    assert "150 messages up to tick 49 were recovered" in trace.notes[0]


def test_a_file_has_the_checksums_of_the_mcap_specification(make_bag):
    """The library of the format's authors checks those of chunks and data; the summary's here."""
    file = make_bag(compress=True) / "run.mcap"
    content = file.read_bytes()
    with file.open("rb") as opened:
        reader = make_reader(opened, validate_crcs=True)
        assert len(list(reader.iter_messages())) == 600
    with file.open("rb") as opened:
        ends = [r for r in StreamReader(opened, validate_crcs=True).records if r is not None]
    (data_end,) = (record for record in ends if isinstance(record, DataEnd))
    (footer,) = (record for record in ends if isinstance(record, Footer))
    assert data_end.data_section_crc == zlib.crc32(content[: footer.summary_start - 13])
    assert footer.summary_crc == zlib.crc32(content[footer.summary_start : -12])


def test_damage_beside_the_chunks_is_told_and_costs_no_message(make_bag):
    path = make_bag()
    file = path / "run.mcap"
    content = bytearray(file.read_bytes())
    place = content.index(b"serialized_metadata") + 40
    content[place] ^= 1
    file.write_bytes(content)
    trace = read_bag(path, repair_damage=False)
    assert trace.message_count == 600
    assert any("a checksum does not fit" in note for note in trace.notes)


@pytest.mark.parametrize("share", [0.3, 0.6, 0.95])
def test_a_compressed_bag_that_is_cut_off_gives_what_is_before_the_cut(make_bag, share):
    """A block of zstd, 128 kB of messages, is unpacked whole or not at all."""
    path = make_bag(count=4000, per_chunk=4000, compress=True, flush_seconds=60.0)
    whole = read_bag(path)
    (path / "metadata.yaml").unlink()
    content = (path / "run.mcap").read_bytes()
    _cut(path, int(share * len(content)))
    trace = read_bag(path)
    assert len(trace["/driver/torque"]) > share * 4000 - 131072 / 250
    for topic in whole.types:
        count = len(trace[topic])
        assert np.array_equal(trace[topic], whole[topic][:count])
    assert read_bag(path).complete
