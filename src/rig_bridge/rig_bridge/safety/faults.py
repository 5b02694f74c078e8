"""What can be wrong with a rig."""

from __future__ import annotations

from enum import StrEnum
from typing import NamedTuple


class Kind(StrEnum):
    """Kinds of faults; each leads to the safe state."""

    LINK = "link lost"
    STALE = "no new measurements"
    FRAMES = "repeated, late or lost frames"
    CLOCK_STEP = "rig's clock jumped"
    CLOCK_DRIFT = "rig's clock drifts"
    NOT_FINITE = "no number"
    RANGE = "out of range"
    RATE = "changes too fast"
    FROZEN = "frozen"
    BAD_SAMPLES = "too many bad samples"
    DISAGREEMENT = "signals disagree"
    COMMAND_NOT_FINITE = "command is no number"
    COMMAND_STALE = "no new commands"
    RIG = "rig reports its safe state"
    START_UP = "start-up checks failed"


class Fault(NamedTuple):
    """A fault: what, where (channel or relation, or None) and the numbers."""

    kind: Kind
    where: str | None
    text: str

    def __str__(self) -> str:
        place = "" if self.where is None else f"{self.where}: "
        return f"{place}{self.kind.value} ({self.text})"
