"""How late a process is that only sleeps from millisecond to millisecond; at SIGTERM it tells.

    python _sleeper.py SECONDS

SECONDS: the last so many count, or fewer if it ran for less. Where the machine stands still, each
millisecond that passed meanwhile is late, as each measurement is that waited for the bridge.
"""

from __future__ import annotations

import json
import os
import signal
import sys
import time
from collections import deque

from steering_lockstep.urgency import PRIORITY, hasten, without_pauses

PERIOD = 1_000_000  # ns


def main() -> None:
    """Sleep until SIGTERM; print the numbers of ticks and of those later than a period."""
    ended: list[int] = []
    signal.signal(signal.SIGTERM, lambda number, frame: ended.append(number))
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    late: deque[bool] = deque(maxlen=max(1, round(float(sys.argv[1]) * 1e9 / PERIOD)))
    without_pauses()
    hasten(os.getpid(), PRIORITY)
    due = time.monotonic_ns()
    while not ended:
        due += PERIOD
        time.sleep(max(0, due - time.monotonic_ns()) * 1e-9)
        late.append(time.monotonic_ns() - due > PERIOD)
    print(json.dumps({"ticks": len(late), "late": sum(late)}), flush=True)


if __name__ == "__main__":
    main()
