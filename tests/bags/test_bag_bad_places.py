"""Full disk, forbidden or taken places: the error names the path, what is there stays."""

import errno
import os
from pathlib import Path

import pytest

from steering_bringup.bags import BagError, BagWriter, read_bag


@pytest.fixture
def disk(monkeypatch):
    """A disk with room for `disk.room` more bytes in bags; partial writes like a real one."""

    class Disk:
        room = 1 << 30

    real = os.write

    def write(descriptor: int, data: bytes) -> int:
        if descriptor < 3:
            return real(descriptor, data)
        size = min(len(data), Disk.room)
        if not size:
            raise OSError(errno.ENOSPC, "No space left on device")
        Disk.room -= size
        return real(descriptor, data[:size])

    monkeypatch.setattr(os, "write", write)
    return Disk


@pytest.mark.parametrize("room", [20_000, 25_001, 30_007])
def test_a_full_disk_keeps_the_whole_chunks(tmp_path, topics, random_ticks, disk, room):
    stamps, payloads = random_ticks(1000)
    disk.room = room
    writer = BagWriter(tmp_path / "run", topics, chunk_bytes=4000)
    with pytest.raises(BagError, match=r"run' cannot be written on: No space left.*stay readable"):
        writer.write_block(stamps, payloads)
    with pytest.raises(BagError, match="No space left"):
        writer.write_block(stamps, payloads)
    kept = writer.message_count
    writer.close()
    assert kept > 0
    trace = read_bag(tmp_path / "run")
    assert trace.message_count == kept
    assert trace.gaps == []


def test_what_fits_after_a_failure_leaves_no_hole(tmp_path, topics, random_ticks, disk):
    stamps, payloads = random_ticks(1000)
    disk.room = 12_000
    writer = BagWriter(tmp_path / "run", topics, chunk_bytes=8000)
    with pytest.raises(BagError, match="No space left"):
        writer.write_block(stamps, payloads)
    kept = writer.message_count
    disk.room = 1 << 20
    for topic, rows in payloads.items():
        writer.write(topic, int(stamps[-1]), rows[-1].tobytes())
    writer.close()
    trace = read_bag(tmp_path / "run")
    assert trace.message_count == kept > 0
    assert trace.gaps == []


def test_a_full_disk_in_the_body_of_a_with_block(tmp_path, topics, random_ticks, disk):
    stamps, payloads = random_ticks(1000)
    disk.room = 20_000
    with (
        pytest.raises(BagError, match="No space left"),
        BagWriter(tmp_path / "run", topics, chunk_bytes=4000) as writer,
    ):
        writer.write_block(stamps, payloads)
    assert read_bag(tmp_path / "run").message_count > 0


def test_a_disk_that_is_full_at_the_end(tmp_path, topics, random_ticks, disk):
    stamps, payloads = random_ticks(10)
    writer = BagWriter(tmp_path / "run", topics)
    writer.write_block(stamps, payloads)
    writer.flush()
    disk.room = 10
    with pytest.raises(BagError, match=r"cannot be closed.*30 messages"):
        writer.close()
    disk.room = 1 << 30
    assert read_bag(tmp_path / "run").message_count == 30


def test_an_existing_bag_is_not_overwritten(make_bag, tmp_path, topics):
    path = make_bag(count=3)
    with pytest.raises(BagError, match="run' exists already"):
        BagWriter(path, topics)
    assert read_bag(path).message_count == 9
    BagWriter(path, topics, overwrite=True).close()
    assert read_bag(path).message_count == 0


def test_overwriting_spares_what_is_no_bag(tmp_path, topics):
    folder = tmp_path / "thesis"
    folder.mkdir()
    (folder / "chapter1.tex").write_text("years of work")
    with pytest.raises(BagError, match=r"chapter1\.tex"):
        BagWriter(folder, topics, overwrite=True)
    assert (folder / "chapter1.tex").exists()


def test_a_place_that_cannot_be_written(tmp_path, topics, monkeypatch):
    (tmp_path / "file").write_text("")
    with pytest.raises(BagError, match=r"file/run' cannot be made: Not a directory"):
        BagWriter(tmp_path / "file" / "run", topics)

    def refuse(*_: object, **__: object) -> None:
        raise PermissionError(errno.EACCES, "Permission denied")

    monkeypatch.setattr(Path, "mkdir", refuse)
    with pytest.raises(BagError, match="other' cannot be made: Permission denied"):
        BagWriter(tmp_path / "other", topics)


def test_an_unknown_type_leaves_nothing_behind(tmp_path):
    with pytest.raises(BagError, match="steering_msgs/msg/Nonsense"):
        BagWriter(tmp_path / "run", {"/x": "steering_msgs/msg/Nonsense"})
    assert not (tmp_path / "run").exists()


def test_a_topic_that_was_not_announced(tmp_path, topics):
    with BagWriter(tmp_path / "run", topics) as writer, pytest.raises(BagError, match="/other"):
        writer.write("/other", 0, b"")


def test_an_error_in_the_run_is_the_bags_outcome(tmp_path, topics, random_ticks):
    stamps, payloads = random_ticks(10)

    def run() -> None:
        with BagWriter(tmp_path / "run", topics) as writer:
            writer.write_block(stamps, payloads)
            raise RuntimeError("the driver went silent at tick 10")

    with pytest.raises(RuntimeError):
        run()
    trace = read_bag(tmp_path / "run")
    assert trace.complete
    assert trace.outcome == "failed: RuntimeError: the driver went silent at tick 10"
