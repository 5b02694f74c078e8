"""A member of the lock step alone in a process: python -m ... KIND --graph FILE --ticks N."""

from __future__ import annotations

import sys

from steering_lockstep.kinds import factory
from steering_lockstep.standalone import spin_alone

if __name__ == "__main__":
    kind = sys.argv.pop(1)
    spin_alone(kind, factory(kind))
