"""How long ago this command was started."""

from __future__ import annotations

import os
import time
from pathlib import Path

_IMPORTED = time.monotonic()
START_TIME_FIELD = 19
"""Position of the start time in /proc/self/stat, counted after the process's name."""


def process_age() -> float:
    """Return the seconds since this process began, whatever program it was before.

    ``./steer`` turns into the command line without a new process, so its set-up counts. Where
    there is no /proc, the time since this module was imported.
    """
    try:
        fields = Path("/proc/self/stat").read_text(encoding="ascii").rpartition(")")[2].split()
        started = int(fields[START_TIME_FIELD]) / os.sysconf("SC_CLK_TCK")
        return time.clock_gettime(time.CLOCK_BOOTTIME) - started
    except (OSError, ValueError, AttributeError):
        return time.monotonic() - _IMPORTED
