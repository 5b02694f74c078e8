"""Stamps notice what is gone, and only that."""

import os

import pytest

from bootstrap import stamp


@pytest.fixture
def top(tmp_path):
    folder = tmp_path / "env-1"
    (folder / "lib" / "package" / "__pycache__").mkdir(parents=True)
    (folder / "lib" / "package" / "module.py").write_text("x = 1\n")
    (folder / "lib" / "package" / "__pycache__" / "module.pyc").touch()
    (folder / "lib" / "libmessage.so").write_bytes(b"0123456789")
    stamp.write(folder, colour="blue")
    return folder


def facts(top):
    found = stamp.read(top)
    assert found is not None
    return found


def damage(top):
    return stamp.damage(top, facts(top))


def test_whole_folder_has_no_damage(top):
    assert facts(top)["colour"] == "blue"
    assert damage(top) == []


def test_deleted_module_is_named(top):
    (top / "lib/package/module.py").unlink()
    assert damage(top) == ["lib/package/module.py"]


def test_deleted_folder_is_named(top):
    for name in ("module.py", "__pycache__/module.pyc"):
        (top / "lib/package" / name).unlink()
    (top / "lib/package/__pycache__").rmdir()
    (top / "lib/package").rmdir()
    assert "lib/package" in damage(top)


def test_shortened_library_is_named(top):
    (top / "lib/libmessage.so").write_bytes(b"01234")
    assert damage(top) == ["lib/libmessage.so"]


def test_link_to_nothing_is_named(top):
    (top / "lib/libother.so").symlink_to(top / "lib/libmessage.so")
    stamp.write(top)
    (top / "lib/libmessage.so").unlink()
    assert set(damage(top)) == {"lib/libmessage.so", "lib/libother.so"}


def test_addition_is_harmless_and_remembered(top):
    (top / "lib" / "cache.txt").touch()
    before = facts(top)["manifest"]["folders"]["lib"][0]
    assert damage(top) == []
    after = facts(top)["manifest"]["folders"]["lib"][0]
    assert after != before
    assert after == os.stat(top / "lib").st_mtime_ns


def test_removed_caches_are_harmless(top):
    (top / "lib/package/__pycache__/module.pyc").unlink()
    (top / "lib/package/__pycache__").rmdir()
    assert damage(top) == []


@pytest.mark.parametrize("text", ["", "{", "[]", "null", '{"manifest": {}}', '{"manifest": 3}'])
def test_cut_stamp_counts_as_half_made(top, text):
    stamp.file_of(top).write_text(text)
    assert stamp.read(top) is None


def test_no_stamp_counts_as_half_made(top):
    stamp.file_of(top).unlink()
    assert stamp.read(top) is None
