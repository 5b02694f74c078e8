"""A small process that has imported everything once and forks the node processes.

Forking the caller itself would be unsound: it may have threads (a progress bar, a linear algebra
library), and its imports are none of ours. The zygote has one thread, no ROS context and nothing
open but the socket to its owner. When the owner goes away, however it does, it ends, and what it
forked with it.
"""

from __future__ import annotations

import contextlib
import os
import pickle
import signal
import socket
import subprocess
import sys
import time
from collections.abc import Sequence
from multiprocessing.connection import Connection, Pipe
from typing import Any

PRELOADED = ("steering_lockstep.worker",)
LENGTH = 4
ORPHAN_GRACE = 3.0
_BOOT = (
    "import sys; sys.path[:] = {path!r}; from steering_lockstep.zygote import serve; serve({fd})"
)


class Zygote:
    """The owner's side. ``modules`` are imported once, in the background, as it is made.

    Use as a context manager, and for several runs one after the other where time matters.
    """

    def __init__(self, modules: Sequence[str] = ()) -> None:
        self._socket, theirs = socket.socketpair()
        boot = _BOOT.format(path=sys.path, fd=theirs.fileno())
        environment = {**os.environ, "OPENBLAS_NUM_THREADS": "1", "OMP_NUM_THREADS": "1"}
        with theirs:
            self._process = subprocess.Popen(
                [sys.executable, "-c", boot],
                pass_fds=[theirs.fileno()],
                stdin=subprocess.DEVNULL,
                env=environment,
            )
        _send(self._socket, [*PRELOADED, *modules])

    def fork(self, function: str, argument: Any) -> tuple[int, Connection]:
        """Run "module:function"(connection, argument) in a new process; (pid, our connection)."""
        ours, theirs = Pipe()
        with theirs:
            _send(self._socket, ("fork", function, argument))
            socket.send_fds(self._socket, [b"f"], [theirs.fileno()])
        return int(_receive(self._socket)), ours

    def reap(self, pid: int) -> int:
        """Wait for a forked process to end; return its exit code, negative: a signal's number."""
        _send(self._socket, ("reap", pid))
        return int(_receive(self._socket))

    def close(self) -> None:
        """End the zygote and whatever it forked that is still there."""
        self._socket.close()
        try:
            self._process.wait(ORPHAN_GRACE + 2.0)
        except subprocess.TimeoutExpired:
            self._process.kill()
            self._process.wait()

    def __enter__(self) -> Zygote:
        return self

    def __exit__(self, *exception: object) -> None:
        self.close()


def serve(descriptor: int) -> None:
    """Import the owner's modules, then fork and reap as it asks, until it goes away."""
    # Blocked, not ignored, and so in all that is forked: a signal to the whole group is the owner's
    # business alone, and it needs this process to end the others in order.
    signal.pthread_sigmask(signal.SIG_BLOCK, {signal.SIGINT, signal.SIGTERM})
    children: set[int] = set()
    with socket.socket(fileno=descriptor) as owner, contextlib.suppress(EOFError, OSError):
        _import_all(_receive(owner))
        while True:
            request = _receive(owner)
            if request[0] == "reap":
                _send(owner, _wait(request[1]))
                children.discard(request[1])
            else:
                children.add(_fork(owner, *request[1:]))
    _end(children)


def _import_all(modules: Sequence[str]) -> None:
    import gc
    import importlib

    for module in modules:
        # A missing or broken module is reported by the process that needs it.
        with contextlib.suppress(Exception):
            importlib.import_module(module)
    gc.freeze()


def _fork(owner: socket.socket, function: str, argument: Any) -> int:
    _, descriptors, _, _ = socket.recv_fds(owner, 1, 1)
    pid = os.fork()
    if pid:
        os.close(descriptors[0])
        _send(owner, pid)
        return pid
    code = 1
    try:
        owner.close()
        _call(function, Connection(descriptors[0]), argument)
        code = 0
    except BaseException:
        sys.excepthook(*sys.exc_info())
    finally:
        with contextlib.suppress(Exception):
            sys.stdout.flush()
            sys.stderr.flush()
        os._exit(code)


def _call(function: str, connection: Connection, argument: Any) -> None:
    import importlib

    module, name = function.split(":")
    getattr(importlib.import_module(module), name)(connection, argument)


def _wait(pid: int) -> int:
    return os.waitstatus_to_exitcode(os.waitpid(pid, 0)[1])


def _end(children: set[int]) -> None:
    """Give orphans time to close (their connections are gone too), then kill them."""
    deadline = time.monotonic() + ORPHAN_GRACE
    while children and time.monotonic() < deadline:
        children -= {pid for pid in children if os.waitpid(pid, os.WNOHANG)[0]}
        time.sleep(0.02)
    for pid in children:
        os.kill(pid, signal.SIGKILL)
        os.waitpid(pid, 0)


def _send(link: socket.socket, message: Any) -> None:
    data = pickle.dumps(message)
    link.sendall(len(data).to_bytes(LENGTH, "little") + data)


def _receive(link: socket.socket) -> Any:
    return pickle.loads(_exactly(link, int.from_bytes(_exactly(link, LENGTH), "little")))


def _exactly(link: socket.socket, size: int) -> bytes:
    data = b""
    while len(data) < size:
        part = link.recv(size - len(data))
        if not part:
            raise EOFError("the other side of the zygote's socket is gone")
        data += part
    return data
