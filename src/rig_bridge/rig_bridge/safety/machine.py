"""The state machine: when the rig may be driven, as a function of what was seen in a tick."""

from __future__ import annotations

from enum import Enum
from typing import NamedTuple


class State(Enum):
    """``CHECKING`` and ``SAFE`` send the safe commands; ``ENTERING`` brings the asked ones in."""

    CHECKING = "checking"
    ENTERING = "entering"
    RUNNING = "running"
    SAFE = "safe"


class Seen(NamedTuple):
    """What a tick brought. ``checked``: start-up checks passed; ``entered``: commands are in.

    ``reset``: a person has just asked to leave the safe state.
    """

    fault: bool = False
    checked: bool = False
    entered: bool = False
    reset: bool = False


def next_state(state: State, seen: Seen) -> State:
    """Return the state of the next tick. A fault wins over everything; the safe state is kept."""
    if seen.fault:
        return State.SAFE
    if state is State.SAFE:
        return State.CHECKING if seen.reset else State.SAFE
    if state is State.CHECKING and seen.checked:
        return State.ENTERING
    if state is State.ENTERING and seen.entered:
        return State.RUNNING
    return state
