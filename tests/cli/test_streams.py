"""Terminals, pipes and shells as they are: no character and no closed stream ends a command."""

import errno
import os
import subprocess
import sys
from concurrent.futures import ProcessPoolExecutor

import pytest

from steering_bringup.pages.page import Page
from steering_core import compiled
from steering_core.errors import BenchError
from steering_studies import parallel

LIST = [sys.executable, "-m", "steering_bringup.cli", "list", "parameters"]


def call(redirection, words=LIST, **variables):
    environment = {**os.environ, "PYTHONPATH": os.pathsep.join(p for p in sys.path if p)}
    return subprocess.run(
        ["sh", "-c", f'"$@" {redirection}', "sh", *words],
        env=environment | variables, capture_output=True, text=True, timeout=120, check=False,
    )  # fmt: skip


def test_what_an_ascii_terminal_cannot_show_is_replaced():
    done = call("", PYTHONIOENCODING="ascii", PYTHONUTF8="0")
    assert (done.returncode, done.stderr) == (0, "")
    assert "?" in done.stdout
    assert done.stdout.isascii()


@pytest.mark.parametrize("redirection", ["<&-", ">&-", "2>&-", "<&- >&- 2>&-"])
def test_a_closed_stream_ends_nothing(redirection, tmp_path):
    file = tmp_path / "list.json"
    done = call(redirection, [*LIST, "rack_mass", "--json", str(file)])
    assert (done.returncode, done.stderr) == (0, "")
    assert file.read_text().startswith("{")
    assert "rack_mass" in file.read_text()


def test_a_full_disk_behind_the_output_is_one_line():
    done = call("> /dev/full")
    assert done.returncode == 1
    assert done.stderr.count("\n") == 1
    assert "No space left" in done.stderr


def test_a_mask_that_takes_files_from_their_owner_is_not_followed(tmp_path):
    file = tmp_path / "list.json"
    words = ["sh", "-c", 'umask 0777; exec "$@"', "sh", *LIST, "--json", str(file)]
    assert call("", words).returncode == 0
    assert file.stat().st_mode & 0o777 == 0o600


def test_a_name_that_is_not_utf_8_is_printed():
    done = call("", [*LIST[:-1], os.fsdecode(b"no\xff")])
    assert done.returncode == 2
    assert "unknown list 'no\\udcff'" in done.stderr
    assert "Unicode" not in done.stderr


def test_a_page_about_such_a_file_is_written(tmp_path):
    page = Page("of " + os.fsdecode(b"a\xff.mcap"))
    page.write(tmp_path / "page.html")
    assert "of a?.mcap" in (tmp_path / "page.html").read_text(encoding="utf-8")


@pytest.mark.parametrize(
    "error", [OSError(errno.ENOSPC, "No space left on device"), ImportError("no semaphores")]
)
def test_without_shared_memory_one_process_does_the_work(error, monkeypatch, capsys):
    def refuse(*arguments):
        raise error

    monkeypatch.setattr(parallel, "ProcessPoolExecutor", refuse)
    with parallel.pool(3) as executor:
        assert executor is None
    said = capsys.readouterr().err
    assert said.startswith("one process in place of 3: ")
    assert "/dev/shm" in said
    assert said.count("\n") == 1


def test_with_shared_memory_there_are_processes():
    with parallel.pool(2) as executor:
        assert isinstance(executor, ProcessPoolExecutor)


def test_a_kernel_cache_that_cannot_be_written_is_named(monkeypatch):
    monkeypatch.setenv("STEER_KERNEL_CACHE", "/proc/none")
    with pytest.raises(BenchError, match="STEER_KERNEL_CACHE names '/proc/none'"):
        compiled.cache_root()


@pytest.mark.parametrize("cache", ["/proc/none", "/dev/null/x"])
def test_without_a_user_s_cache_the_kernels_have_a_temporary_one(cache, monkeypatch, tmp_path):
    monkeypatch.delenv("STEER_KERNEL_CACHE", raising=False)
    monkeypatch.setenv("XDG_CACHE_HOME", cache)
    monkeypatch.setattr("tempfile.tempdir", str(tmp_path))
    assert compiled.cache_root().parent == tmp_path


def test_a_relative_cache_is_not_made_where_one_happens_to_be(monkeypatch, tmp_path):
    monkeypatch.delenv("STEER_KERNEL_CACHE", raising=False)
    monkeypatch.setenv("XDG_CACHE_HOME", "relative")
    monkeypatch.setenv("HOME", str(tmp_path / "home"))
    monkeypatch.chdir(tmp_path)
    assert compiled.cache_root() == tmp_path / "home" / ".cache" / "steering-kernels"
    assert not (tmp_path / "relative").exists()
