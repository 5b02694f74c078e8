"""How the emulated rig is told to end: by a signal, which never cuts through what it is doing."""

from __future__ import annotations

import signal
from types import FrameType

ENDING = (signal.SIGTERM, signal.SIGINT)


class Stop:
    """``asked`` once a signal has come since ``listen``; whoever runs looks at it each period.

    Before ``listen`` a signal ends the process at once: there is nothing to close yet.
    """

    def __init__(self) -> None:
        self.asked = False
        for number in ENDING:
            signal.signal(number, signal.SIG_DFL)

    def listen(self) -> None:
        """Take signals as the wish to end; from here on none of them interrupts anything."""
        for number in ENDING:
            signal.signal(number, self._ask)

    def ignore(self) -> None:
        """Pass over what still comes: the end is near, and another signal must not spoil it.

        Blocked first: Python complains of one that comes while its handler is taken away.
        """
        signal.pthread_sigmask(signal.SIG_BLOCK, ENDING)
        for number in ENDING:
            signal.signal(number, signal.SIG_IGN)

    def _ask(self, number: int, frame: FrameType | None) -> None:
        self.asked = True
