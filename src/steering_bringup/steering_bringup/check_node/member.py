"""A member of the lock step alone in a process: python -m ... KIND --graph FILE --ticks N."""

from __future__ import annotations

import sys

from steering_lockstep.executables import run

if __name__ == "__main__":
    run(sys.argv.pop(1))
