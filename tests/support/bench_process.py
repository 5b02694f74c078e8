"""The command line as a real process of its own, with all that belongs to it, for tests."""

from __future__ import annotations

import os
import subprocess
import sys
import time
import uuid
from collections.abc import Callable
from pathlib import Path
from typing import Any

MARK = "STEER_TEST_MARK"


class Bench:
    """``steer WORDS`` in ``folder``, in a process group of its own, marked by its environment."""

    def __init__(self, *words: str, folder: Path, **options: Any) -> None:
        self.mark = uuid.uuid4().hex
        self.shared_memory = shared_memory()
        path = os.pathsep.join(dict.fromkeys(p for p in [*extra_path(options), *sys.path] if p))
        environment = {**os.environ, "PYTHONPATH": path, MARK: self.mark}
        self.process = subprocess.Popen(
            [sys.executable, "-m", "steering_bringup.cli", *words],
            cwd=folder,
            env=environment,
            stdout=subprocess.PIPE,
            stderr=subprocess.PIPE,
            text=True,
            start_new_session=True,
            **options,
        )

    def finish(self, timeout: float = 90.0) -> tuple[int, str, str]:
        """Wait for the end; return (exit status, standard output, standard error)."""
        out, err = self.process.communicate(timeout=timeout)
        return self.process.returncode, out, err

    def node_pids(self) -> list[int]:
        """Return the node processes, oldest first: children of the command's only child."""
        helpers = children(self.process.pid)
        return sorted(children(helpers[0])) if helpers else []

    def left_over(self) -> list[str]:
        """Return processes that still carry the mark, and new files in shared memory."""
        processes = [f"process {pid}" for pid in marked(self.mark) if pid != self.process.pid]
        files = orphans(shared_memory() - self.shared_memory)
        return processes + [f"/dev/shm/{name}" for name in files]


def extra_path(options: dict[str, Any]) -> list[str]:
    """Take folders of modules for the run's nodes out of ``options``."""
    return [str(folder) for folder in options.pop("modules", ())]


def wait_for(condition: Callable[[], Any], seconds: float = 60.0) -> Any:
    """Return the condition's value as soon as it is true; fail after ``seconds``."""
    deadline = time.monotonic() + seconds
    while time.monotonic() < deadline:
        value = condition()
        if value:
            return value
        time.sleep(0.02)
    raise AssertionError("waited in vain")


def children(pid: int) -> list[int]:
    """Return the pids of a process's children."""
    found = []
    for stat in Path("/proc").glob("[0-9]*/stat"):
        try:
            fields = stat.read_text().rpartition(")")[2].split()
        except OSError:
            continue
        if int(fields[1]) == pid and fields[0] != "Z":
            found.append(int(stat.parent.name))
    return found


def marked(mark: str) -> list[int]:
    """Return the living processes whose environment carries ``mark``."""
    found = []
    for file in Path("/proc").glob("[0-9]*/environ"):
        try:
            if f"{MARK}={mark}".encode() in file.read_bytes():
                found.append(int(file.parent.name))
        except OSError:
            continue
    return found


def shared_memory() -> set[str]:
    """Return the names of the files in shared memory."""
    folder = Path("/dev/shm")
    return {path.name for path in folder.iterdir()} if folder.is_dir() else set()


def orphans(names: set[str]) -> list[str]:
    """Return those files in shared memory that no other living process uses.

    Another run on the same machine may make files of its own at any moment.
    """
    used: set[str] = set()
    for process in Path("/proc").glob("[0-9]*") if names else ():
        if process.name != str(os.getpid()):
            used |= open_in(process)
    return sorted(name for name in names if name not in used and Path("/dev/shm", name).exists())


def open_in(process: Path) -> set[str]:
    """Return the names of the files in shared memory that a process has mapped or open."""
    try:
        paths = [os.readlink(link) for link in (process / "fd").iterdir()]
        paths += [
            line.split(maxsplit=5)[-1]
            for line in (process / "maps").read_text().split("\n")
            if "/dev/shm/" in line
        ]
    except OSError:
        return set()
    return {path.removeprefix("/dev/shm/") for path in paths if path.startswith("/dev/shm/")}


def recorded_bytes(bag: Path) -> int:
    """Return how much a bag holds on disk so far."""
    return sum(file.stat().st_size for file in bag.glob("*.mcap"))
