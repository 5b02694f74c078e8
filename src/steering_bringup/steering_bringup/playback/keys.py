"""Keys typed while a bag plays; only where standard input is a terminal of our own."""

from __future__ import annotations

import os
import select
import sys
import termios
import time
import tty
from typing import Any

PAUSE, STEP, FASTER, SLOWER, QUIT = "pause", "step", "faster", "slower", "quit"
MEANING = {
    b" ": PAUSE,
    b"s": STEP,
    b"\x1b[C": STEP,
    b"\x1bOC": STEP,
    b"+": FASTER,
    b"\x1b[A": FASTER,
    b"\x1bOA": FASTER,
    b"-": SLOWER,
    b"\x1b[B": SLOWER,
    b"\x1bOB": SLOWER,
    b"q": QUIT,
}
HELP = "space: pause, s or right: step, up and down: rate, q: end"


class Keys:
    """Waits, and tells which keys came meanwhile. Use as a context manager.

    The terminal is put back on leaving. Without a terminal, or in the background, ``wait`` only
    waits.
    """

    def __init__(self) -> None:
        self._descriptor: int | None = None
        self._before: list[Any] = []
        self._pending = b""

    @property
    def active(self) -> bool:
        """Whether there is a keyboard."""
        return self._descriptor is not None

    def wait(self, seconds: float) -> list[str]:
        """Wait at most ``seconds``, less if a key comes; return the meanings of the keys."""
        if self._descriptor is None:
            if seconds > 0.0:
                time.sleep(seconds)
            return []
        ready, _, _ = select.select([self._descriptor], [], [], max(seconds, 0.0))
        if not ready:
            return []
        typed = os.read(self._descriptor, 64)
        if not typed:
            self._descriptor = None  # the terminal is gone
        return self._meanings(typed)

    def _meanings(self, typed: bytes) -> list[str]:
        """Cut what was typed into keys; the start of an arrow's sequence waits for its rest."""
        self._pending += typed
        found = []
        while self._pending:
            key = next((k for k in MEANING if self._pending.startswith(k)), None)
            if key is None and any(k.startswith(self._pending) for k in MEANING):
                break
            found += [MEANING[key]] if key else []
            self._pending = self._pending[len(key) if key else 1 :]
        return found

    def __enter__(self) -> Keys:
        try:
            descriptor = sys.stdin.fileno()
            # Reading a terminal from the background would stop the process.
            if os.isatty(descriptor) and os.tcgetpgrp(descriptor) == os.getpgrp():
                self._before = termios.tcgetattr(descriptor)
                tty.setcbreak(descriptor, termios.TCSANOW)
                self._descriptor = descriptor
        except (OSError, ValueError, AttributeError, termios.error):
            self._descriptor = None
        return self

    def __exit__(self, *exception: object) -> None:
        if self._before:
            termios.tcsetattr(sys.stdin.fileno(), termios.TCSADRAIN, self._before)
