"""A small process that has imported everything once and forks the node processes.

Forking the caller itself would be unsound: it may have threads (a progress bar, a linear algebra
library), and its imports are none of ours. The zygote has one thread, no ROS context and nothing
open but the socket to its owner. When the owner goes away, however it does, it ends, and what it
forked with it. What it has called itself, such as compiled kernels, the forked processes have too.
"""

from __future__ import annotations

import contextlib
import ctypes
import gc
import importlib
import os
import pickle
import signal
import socket
import subprocess
import sys
import time
from collections.abc import Sequence
from multiprocessing.connection import Connection, Pipe
from pkgutil import resolve_name
from typing import Any

from steering_core.errors import BenchError

PRELOADED = ("steering_lockstep.worker",)
LENGTH = 4
ORPHAN_GRACE = 3.0
PR_SET_PDEATHSIG = 1
"""Of Linux's prctl."""
_BOOT = (
    "import sys; sys.path[:] = {path!r}; from steering_lockstep.zygote import serve; serve({fd})"
)


class Zygote:
    """The owner's side. ``modules`` are imported once, in the background, as it is made.

    Use as a context manager, and for several runs one after the other where time matters.
    """

    def __init__(self, modules: Sequence[str] = ()) -> None:
        self._has_forked = False
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
        self.load([*PRELOADED, *modules])

    def load(self, modules: Sequence[str]) -> None:
        """Import ``modules`` in the background."""
        _send(self._socket, ("load", list(modules)))

    def call(self, function: str, argument: Any) -> Any:
        """Return what "module:function"(argument) gives there, or raise what it raises.

        While nothing that was forked is left: a Ctrl-C ends the zygote meanwhile.
        """
        try:
            _send(self._socket, ("call", function, argument))
            value, error = _receive(self._socket)
        except (EOFError, OSError):
            status = self._process.wait()
            text = f"the process that prepares the nodes ended (status {status}): run it again"
            raise BenchError(text) from None
        if error is not None:
            raise error
        return value

    def fork(self, function: str, argument: Any) -> tuple[int, Connection]:
        """Run "module:function"(connection, argument) in a new process; (pid, our connection)."""
        self._has_forked = True
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
        if not self._has_forked:
            self._process.kill()  # it may be importing for seconds
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
    """Import, call, fork and reap as the owner asks, until it goes away."""
    # Blocked, not ignored, and so in all that is forked: a signal to the whole group is the owner's
    # business alone, and it needs this process to end the others in order.
    signal.pthread_sigmask(signal.SIG_BLOCK, {signal.SIGINT, signal.SIGTERM})
    signal.signal(signal.SIGINT, signal.SIG_DFL)
    children: set[int] = set()
    with socket.socket(fileno=descriptor) as owner, contextlib.suppress(EOFError, OSError):
        while True:
            kind, *request = _receive(owner)
            if kind == "load":
                _import_all(*request)
            elif kind == "call":
                _send(owner, _answer(*request))
            elif kind == "reap":
                _send(owner, _wait(*request))
                children.discard(*request)
            else:
                children.add(_fork(owner, *request))
    _end(children)


def _import_all(modules: Sequence[str]) -> None:
    for module in modules:
        # A missing or broken module is reported by the process that needs it.
        with contextlib.suppress(Exception):
            importlib.import_module(module)
    gc.freeze()


def _answer(function: str, argument: Any) -> tuple[Any, Exception | None]:
    """Call a function; a call may take a minute, and then nobody may be there any more."""
    _end_with_owner(True)
    signal.pthread_sigmask(signal.SIG_UNBLOCK, {signal.SIGINT})
    try:
        return resolve_name(function)(argument), None
    except Exception as error:
        return None, error if _travels(error) else RuntimeError(f"{type(error).__name__}: {error}")
    finally:
        signal.pthread_sigmask(signal.SIG_BLOCK, {signal.SIGINT})
        _end_with_owner(False)
        gc.freeze()


def _travels(error: Exception) -> bool:
    try:
        return type(pickle.loads(pickle.dumps(error))) is type(error)
    except Exception:
        return False


def _end_with_owner(at_once: bool) -> None:
    """Let the kernel kill this process when its owner ends, where the kernel is Linux's."""
    with contextlib.suppress(OSError, AttributeError):
        ctypes.CDLL(None).prctl(PR_SET_PDEATHSIG, signal.SIGKILL if at_once else 0)


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
        resolve_name(function)(Connection(descriptors[0]), argument)
        code = 0
    except BaseException:
        sys.excepthook(*sys.exc_info())
    finally:
        with contextlib.suppress(Exception):
            sys.stdout.flush()
            sys.stderr.flush()
        os._exit(code)


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
