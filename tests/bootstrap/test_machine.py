"""One line for whatever the machine lacks."""

import platform
import shutil
from pathlib import Path

import pytest

from bootstrap import machine
from bootstrap.errors import SetupError
from bootstrap.layout import Layout


def complaint(root: Path) -> str:
    with pytest.raises(SetupError) as caught:
        machine.check(Layout(root))
    assert "\n" not in str(caught.value)
    return str(caught.value)


def test_missing_programs_are_named_together_with_their_packages(tmp_path, monkeypatch):
    monkeypatch.setenv("PATH", str(tmp_path))
    monkeypatch.delenv("CC", raising=False)
    monkeypatch.delenv("CXX", raising=False)
    line = complaint(tmp_path)
    for thing in ("C compiler", "C++ compiler", "cmake", "make"):
        assert thing in line
    assert "sudo apt install cmake g++ gcc make" in line


def test_chosen_compiler_that_does_not_exist_is_missing(tmp_path, monkeypatch):
    monkeypatch.setenv("CXX", "no-such-compiler -O2")
    assert machine.missing_packages(Layout(tmp_path)) == {"C++ compiler": "g++"}


def test_complete_machine_passes(tmp_path):
    machine.check(Layout(tmp_path))


def test_path_that_colcon_cannot_build_is_refused(tmp_path):
    assert "a path with $ :" in complaint(tmp_path / "a:b$c")


def test_other_processor_is_refused(tmp_path, monkeypatch):
    monkeypatch.setattr(platform, "machine", lambda: "aarch64")
    assert "aarch64" in complaint(tmp_path)


def test_other_processor_is_welcome_beside_a_sourced_ros(tmp_path, monkeypatch):
    monkeypatch.setattr(platform, "machine", lambda: "aarch64")
    monkeypatch.setattr(machine, "_programs", lambda layout: None)
    machine.check(Layout(tmp_path, system_ros=True))


@pytest.mark.parametrize("libc", [("glibc", "2.27"), ("", "")])
def test_old_or_other_c_library_is_refused(tmp_path, monkeypatch, libc):
    monkeypatch.setattr(platform, "libc_ver", lambda: libc)
    assert "glibc 2.28" in complaint(tmp_path)


def test_full_disk_is_seen_before_the_work(tmp_path, monkeypatch):
    usage = shutil.disk_usage(tmp_path)._replace(free=100_000_000)
    monkeypatch.setattr(shutil, "disk_usage", lambda _: usage)
    assert "0.1 GB free" in complaint(tmp_path)
