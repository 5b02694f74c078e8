"""Processes that a run with an emulated rig starts: each ends with the run, however that ends."""

from __future__ import annotations

import json
import os
import select
import signal
import subprocess
import sys
import threading
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import Any

from steering_core.errors import BenchError

GRACE_S = 5.0
STDIN, CHUNK = 0, 4096


def end_with_input() -> None:
    """Send this process a SIGTERM when its standard input is closed, as by the owner's death."""

    def watch() -> None:
        # Signals are the main thread's, which can then hold them off while it closes.
        signal.pthread_sigmask(signal.SIG_BLOCK, signal.valid_signals())
        # Not through sys.stdin: its lock, held here, would abort the process at its end.
        while os.read(STDIN, CHUNK):
            pass
        os.kill(os.getpid(), signal.SIGTERM)

    threading.Thread(target=watch, name="owner", daemon=True).start()


@contextmanager
def helper(module: str, arguments: Sequence[str], timeout_s: float) -> Iterator[Helper]:
    """Start ``python -m module``, wait for its first line (JSON), and stop it at the end.

    It must end with its standard input. Raises BenchError when it ends or says nothing in time.
    """
    process = subprocess.Popen(
        [sys.executable, "-m", module, *arguments],
        stdin=subprocess.PIPE,
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
        env={**os.environ, "PYTHONPATH": os.pathsep.join(path for path in sys.path if path)},
        start_new_session=True,  # a Ctrl-C is the run's business: the bridge comes first
    )
    try:
        yield Helper(module, process, _first_line(module, process, timeout_s))
    finally:
        process.terminate()
        try:
            process.communicate(timeout=GRACE_S)
        except subprocess.TimeoutExpired:
            process.kill()
            process.communicate()


class Helper:
    """A running helper: its process and what its first line said."""

    def __init__(self, module: str, process: subprocess.Popen[str], said: dict[str, Any]) -> None:
        self.module = module
        self.process = process
        self.said = said

    def ended(self) -> str | None:
        """Return how the process has ended on its own; None while it runs."""
        status = self.process.poll()
        if status is None:
            return None
        return f"killed by {signal.Signals(-status).name}" if status < 0 else f"status {status}"


def _first_line(module: str, process: subprocess.Popen[str], timeout_s: float) -> dict[str, Any]:
    assert process.stdout is not None
    assert process.stderr is not None
    ready, _, _ = select.select([process.stdout], [], [], timeout_s)
    line = process.stdout.readline() if ready else ""
    if line:
        return dict(json.loads(line))
    name = Path(module.replace(".", "/")).name
    if not ready:
        raise BenchError(f"the process of {module} was not ready after {timeout_s:g} s")
    text = process.stderr.read().strip().splitlines() or [f"{name} ended without a word"]
    raise BenchError(text[-1])
