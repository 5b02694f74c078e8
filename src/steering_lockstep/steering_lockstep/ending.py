"""SIGINT and SIGTERM as news for a thread, whichever thread of the process gets them.

A handler runs in the main thread, which is somewhere in the middleware; and a signal that is
blocked there still ends the process through a thread that a library started before.
"""

from __future__ import annotations

import os
import select
import signal
from types import FrameType

SIGNALS = (signal.SIGINT, signal.SIGTERM)


def end_at_once() -> None:
    """Let the signals end the process without a word, as long as there is nothing to close."""
    for number in SIGNALS:
        signal.signal(number, signal.SIG_DFL)


class Ending:
    """Takes the signals from now on. Made in the main thread, asked by another one."""

    def __init__(self) -> None:
        self._read, write = os.pipe2(os.O_NONBLOCK | os.O_CLOEXEC)
        signal.set_wakeup_fd(write, warn_on_full_buffer=False)
        for number in SIGNALS:
            signal.signal(number, _noted)

    def wait(self, seconds: float) -> int | None:
        """Return the number of the next signal, None after ``seconds``."""
        ready, _, _ = select.select([self._read], [], [], seconds)
        return os.read(self._read, 1)[0] if ready else None

    def ignore(self) -> None:
        """Pass over what still comes: a second signal must not spoil an end that is near."""
        for number in SIGNALS:
            signal.signal(number, signal.SIG_IGN)


def _noted(number: int, frame: FrameType | None) -> None:
    """The interpreter has written the number into the pipe."""
