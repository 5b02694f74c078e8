"""The checked node's process: started with a ROS domain of its own, always ended."""

from __future__ import annotations

import contextlib
import os
import signal
import subprocess
import tempfile
from collections.abc import Sequence
from typing import IO

from steering_bringup.errors import BenchError
from steering_lockstep.middleware import PROFILE_VARIABLE, RANGE, ros_environment

GRACE = 1.5
"""Seconds for a process to end when it is asked to."""


class Program:
    """A running command. Use as a context manager."""

    def __init__(self, command: Sequence[str], domain: int) -> None:
        self._text: IO[bytes] = tempfile.TemporaryFile()  # noqa: SIM115
        try:
            self._process = subprocess.Popen(
                list(command),
                stdin=subprocess.DEVNULL,
                stdout=self._text,
                stderr=subprocess.STDOUT,
                env={**loopback(), "ROS_DOMAIN_ID": str(domain)},
                start_new_session=True,
            )
        except OSError as error:
            self._text.close()
            raise BenchError(f"'{command[0]}' cannot be started: {error.strerror}") from None

    @property
    def status(self) -> int | None:
        """The exit status; None while it runs."""
        return self._process.poll()

    def kill(self) -> None:
        """End it at once, with all that it started."""
        self._signal(signal.SIGKILL)
        self._process.wait()

    def ending(self) -> str:
        """Return how it ended and the last line that it wrote."""
        self._text.seek(0)
        lines = self._text.read().decode(errors="replace").strip().splitlines()
        how = f"ended with status {self.status}"
        return f"{how}: {lines[-1].strip()[:200]}" if lines else f"{how} and wrote nothing"

    def wait(self, seconds: float) -> None:
        """Give it some time to end by itself."""
        with contextlib.suppress(subprocess.TimeoutExpired):
            self._process.wait(seconds)

    def __enter__(self) -> Program:
        return self

    def __exit__(self, *exception: object) -> None:
        self._signal(signal.SIGINT)
        self.wait(GRACE)
        self.kill()
        self._text.close()

    def _signal(self, number: int) -> None:
        with contextlib.suppress(ProcessLookupError):
            os.killpg(self._process.pid, number)


def loopback() -> dict[str, str]:
    """Return the environment of a node that only this computer sees."""
    given = {k: v for k, v in os.environ.items() if k not in (RANGE, PROFILE_VARIABLE)}
    return given | ros_environment(given)
