"""Failures of pip and colcon end as one clear line, or as the end of their log."""

import os
import signal
import subprocess
import sys
import time

import pytest

from bootstrap import logged
from bootstrap.errors import SetupError
from bootstrap.progress import Step


@pytest.fixture
def runner(tmp_path):
    with (tmp_path / "lock").open("w") as lock:
        yield logged.LoggedRunner(tmp_path / "setup.log", lock.fileno())


def run(runner, tmp_path, text):
    runner.run(["sh", "-c", text], dict(os.environ), Step("test"), tmp_path)


def test_success_is_silent_and_logged(runner, tmp_path, capfd):
    run(runner, tmp_path, "echo hello")
    assert "hello" in runner.log.read_text()
    assert capfd.readouterr().out == ""


def test_unknown_failure_shows_the_end_of_its_own_log(runner, tmp_path):
    run(runner, tmp_path, "echo earlier")
    with pytest.raises(SetupError, match="status 3") as caught:
        run(runner, tmp_path, "seq 100; exit 3")
    lines = str(caught.value).splitlines()
    assert lines[-1] == "100"
    assert len(lines) <= logged.TAIL_LINES + 1
    assert "earlier" not in str(caught.value)


@pytest.mark.parametrize(
    ("text", "line"),
    [
        ("OSError: [Errno 28] No space left on device", "the disk is full"),
        ("connection broken by NewConnectionError(...)", "cannot reach the package index"),
        ("Temporary failure in name resolution\nNo space left on device", "the disk is full"),
        ("ERROR: THESE PACKAGES DO NOT MATCH THE HASHES FROM", "not the locked file"),
        ("SSLError(SSLCertVerificationError(1, '[SSL: CERTIFICATE_VERIFY_FAILED]", "certificate"),
    ],
)
def test_known_causes_are_one_line(runner, tmp_path, text, line):
    (tmp_path / "text").write_text(text)
    with pytest.raises(SetupError, match=line) as caught:
        run(runner, tmp_path, "cat text; exit 1")
    assert "\n" not in str(caught.value)
    assert str(runner.log) in str(caught.value)


def test_interruption_ends_the_whole_group(runner, tmp_path, monkeypatch):
    def interrupt(self):
        raise KeyboardInterrupt

    monkeypatch.setattr(Step, "tick", interrupt)
    with pytest.raises(KeyboardInterrupt):
        run(runner, tmp_path, "sleep 60 & echo $! > child; wait")
    child = int((tmp_path / "child").read_text())
    deadline = time.monotonic() + 5
    while alive(child) and time.monotonic() < deadline:
        time.sleep(0.05)
    assert not alive(child)


def alive(process):
    """True while the process runs; one that only waits to be collected does not."""
    state = subprocess.run(
        ["ps", "-o", "stat=", "-p", str(process)], capture_output=True, text=True, check=False
    ).stdout
    return bool(state.strip()) and not state.startswith("Z")


def test_launcher_passes_sigterm_on(tmp_path):
    """The signal handler of set-up turns SIGTERM into an orderly end with status 143."""
    code = (
        "import sys, os, signal\n"
        "from bootstrap.set_up import _ended_by_signal\n"
        "with _ended_by_signal():\n"
        "    os.kill(os.getpid(), signal.SIGTERM)\n"
        "    signal.pause()\n"
    )
    tools = os.path.dirname(os.path.dirname(logged.__file__))
    status = subprocess.run(
        [sys.executable, "-c", code], env={**os.environ, "PYTHONPATH": tools}, check=False
    ).returncode
    assert status == 128 + signal.SIGTERM
