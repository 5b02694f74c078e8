"""Who is checked, and what happened. Pure."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

from steering_bringup.check_node.faults import Heard, Style
from steering_lockstep.topics import OVERLAY

MEMBER = "checked"
"""Name of a member of the lock step in its run."""


@dataclass(frozen=True)
class Subject:
    """The node to be checked: a guest's command line, or a member's kind with its connections."""

    style: Style
    command: tuple[str, ...]
    inputs: tuple[str, ...] = ()
    period: int = 10

    @property
    def wishes(self) -> str:
        """The topic on which it asks."""
        return OVERLAY if self.style == "guest" else f"{OVERLAY}/{MEMBER}"


@dataclass
class Record:
    """What happened: the arbiter's ``rows`` (n, 19), the node's messages as ``heard``, the
    bench's topics that it ``reads``, how its process ``ended`` before its time (else empty)."""

    rows: np.ndarray
    heard: list[Heard] = field(default_factory=list)
    reads: list[str] = field(default_factory=list)
    ended: str = ""
