"""Runs pip and colcon with their output in a file, and explains their failures in one line."""

import os
import re
import signal
import subprocess
from collections.abc import Mapping, Sequence
from contextlib import suppress
from pathlib import Path

from bootstrap.errors import SetupError
from bootstrap.progress import Step

TAIL_LINES = 25
# First match wins: a full disk also breaks downloads, and a missing network looks like a missing
# package.
_OFFLINE = (
    r"NewConnectionError|NameResolutionError|Temporary failure in name resolution|"
    r"Network is unreachable|ConnectTimeoutError|ProxyError|Max retries exceeded|"
    r"Failed to establish a new connection|ReadTimeoutError|Could not fetch URL|"
    r"\(from versions: none\)"
)
CAUSES = (
    (r"No space left on device|Errno 28", "the disk is full: make room and run this again"),
    (
        r"DO NOT MATCH THE HASHES",
        "a download is not the locked file (wrong mirror or damaged cache)",
    ),
    (r"CERTIFICATE_VERIFY_FAILED", "this machine does not trust the package index's certificate"),
    (_OFFLINE, "cannot reach the package index: check network and proxy, then run this again"),
    (r"Killed|out of memory|Cannot allocate memory", "the machine ran out of memory"),
)


class LoggedRunner:
    """Runs commands one after the other into one log file, holding the set-up lock."""

    def __init__(self, log: Path, lock: int) -> None:
        self.log = log
        self.lock = lock

    def run(
        self, command: Sequence[str | Path], environ: Mapping[str, str], shown: Step, cwd: Path
    ) -> None:
        """Run to the end; raise SetupError with the cause and the log's tail on failure."""
        begin = self.log.stat().st_size if self.log.exists() else 0
        with self.log.open("a") as out:
            print("$", *command, file=out, flush=True)
            child = subprocess.Popen(
                command,
                stdin=subprocess.DEVNULL,
                stdout=out,
                stderr=subprocess.STDOUT,
                cwd=cwd,
                env=dict(environ),
                pass_fds=(self.lock,),
                start_new_session=True,
            )
            status = _wait(child, shown)
        if status != 0:
            text = self.log.read_bytes()[begin:].decode(errors="replace")
            raise SetupError(explain(text, Path(str(command[0])).name, status, self.log))


def _wait(child: "subprocess.Popen[bytes]", shown: Step) -> int:
    """Wait with a running clock; whatever ends this process ends the child's whole group."""
    try:
        while True:
            with suppress(subprocess.TimeoutExpired):
                return child.wait(timeout=1.0)
            shown.tick()
    except BaseException:
        _end(child)
        raise


def _end(child: "subprocess.Popen[bytes]") -> None:
    for sign in (signal.SIGTERM, signal.SIGKILL):
        with suppress(ProcessLookupError):
            os.killpg(child.pid, sign)
        with suppress(subprocess.TimeoutExpired):
            child.wait(timeout=3.0)


def cause_of(text: str) -> str | None:
    """One line for a known cause in a log."""
    return next((line for pattern, line in CAUSES if re.search(pattern, text)), None)


def explain(text: str, program: str, status: int, log: Path) -> str:
    """Error text: the cause where it is known, otherwise the tail of the log."""
    cause = cause_of(text)
    if cause:
        return f"{cause} (log: {log})"
    tail = "\n".join(text.rstrip().splitlines()[-TAIL_LINES:])
    return f"{program} failed with status {status}; the end of {log}:\n{tail}"
