"""The progress bar: there on a terminal, silent elsewhere."""

import fcntl
import os
import pty
import struct
import subprocess
import sys
import termios

import pytest

PROGRAM = """
from steering_bringup.progress import Bar
with Bar("closed_centre", 2.0) as bar:
    bar.update(0, 0.0, "matching")
    bar.update(1500, 4.25)
print("done")
"""


def environment() -> dict[str, str]:
    return {**os.environ, "PYTHONPATH": os.pathsep.join(p for p in sys.path if p)}


def test_a_terminal_shows_simulated_time_and_factor():
    ours, theirs = pty.openpty()
    fcntl.ioctl(theirs, termios.TIOCSWINSZ, struct.pack("HHHH", 40, 110, 0, 0))
    words = [sys.executable, "-c", PROGRAM]
    with subprocess.Popen(words, stdout=theirs, stderr=theirs, env=environment()) as process:
        os.close(theirs)
        shown = b""
        try:
            while piece := os.read(ours, 4096):
                shown += piece
        except OSError:
            pass  # the other side is closed
    os.close(ours)
    assert process.returncode == 0
    text = shown.decode()
    assert "closed_centre: matching" in text
    assert "1.5 of 2.0 s, 4.2 x real time" in text
    assert text.rstrip().endswith("done")


@pytest.mark.parametrize("stream", ["stdout", "stderr"])
def test_a_file_or_pipe_gets_nothing(stream):
    done = subprocess.run(
        [sys.executable, "-c", PROGRAM], capture_output=True, env=environment(), check=True
    )
    assert getattr(done, stream) == (b"done\n" if stream == "stdout" else b"")
