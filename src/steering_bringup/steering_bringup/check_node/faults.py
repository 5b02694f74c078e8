"""The faults of ``steer check-node``. A new one is an entry of ``FAULTS``.

Each acts in a window of time: on what the arbiter gets from the node, on what the node gets from
the bench, on the driver's hands, or on the node's process.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from typing import Literal

START, STOP, END = 800, 1450, 2200
"""Ticks: the fault begins, it ends, the run ends."""
LATE = 60
"""Ticks by which a late message comes too late: twice what the arbiter waits for."""
FIGHTING_HAND = 5.0
"""N m against the overlay that the arbiter feels; 3 N m take all authority."""
FAR = 25.0
"""N m by which a torque jumps: within what is believed, far above what is applied."""

Style = Literal["guest", "member"]


@dataclass(frozen=True)
class Heard:
    """A message of the node, heard at ``tick``: torque [N m], priority, source."""

    tick: int
    torque: float
    priority: float
    source: str


Output = Callable[[Heard], Heard | None]
Input = Callable[[Sequence[float], Sequence[float]], Sequence[float] | None]


@dataclass(frozen=True)
class Fault:
    """What is done to whom. ``key``: its name on the command line; ``told``: in the table.

    ``output``: what the arbiter gets in place of a message; None: nothing. ``inputs``: what the
    node gets in place of (fields now, fields at the start of the window). ``refused``: the arbiter
    must refuse it. ``ends``: it must have faded out at the window's end. ``hand``: the driver
    fights. ``styles``: of nodes for which it can happen; in lock step a message cannot be late.
    """

    key: str
    told: str
    output: Output | None = None
    inputs: Input | None = None
    refused: bool = False
    ends: bool = False
    hand: bool = False
    starts_late: bool = False
    killed: bool = False
    styles: tuple[Style, ...] = ("guest", "member")


def _same(heard: Heard) -> Heard:
    return heard


def _jump(heard: Heard) -> Heard:
    far = FAR if heard.tick // 100 % 2 else -FAR
    return replace(heard, torque=max(min(heard.torque + far, 29.0), -29.0))


def _torque(value: float) -> Output:
    return lambda heard: replace(heard, torque=value)


GUEST: tuple[Style, ...] = ("guest",)
FAULTS = {
    fault.key: fault
    for fault in (
        Fault("none", "nothing"),
        Fault("start-late", "the bench runs before the node starts", starts_late=True),
        # to the arbiter
        Fault(
            "late",
            f"its messages come {LATE} ms late",
            lambda heard: replace(heard, tick=heard.tick + LATE),
            styles=GUEST,
        ),
        Fault("silent", "its messages are lost", lambda heard: None, ends=True, styles=GUEST),
        Fault("nan", "its torque is no number", _torque(math.nan), refused=True, ends=True),
        Fault("jump", f"its torque jumps by {FAR:g} N m to and fro", _jump),
        Fault(
            "sign",
            "its torque has the wrong sign",
            lambda heard: replace(heard, torque=-heard.torque),
        ),
        Fault("range", "its torque is 1000 N m", _torque(1000.0), refused=True, ends=True),
        Fault(
            "source",
            "its messages name another source",
            lambda heard: replace(heard, source="somebody_else"),
            styles=GUEST,
        ),
        Fault(
            "nameless",
            "its messages name no source",
            lambda heard: replace(heard, source=""),
            styles=GUEST,
        ),
        Fault(
            "priority",
            "its priority is no number",
            lambda heard: replace(heard, priority=math.nan),
            refused=True,
            ends=True,
        ),
        Fault(
            "driver",
            f"the torsion bar tells of a driver who fights with {FIGHTING_HAND:g} N m",
            hand=True,
            ends=True,
        ),
        # to the node
        Fault("inputs-stop", "its inputs stop", inputs=lambda now, then: None, styles=GUEST),
        Fault("inputs-freeze", "its inputs freeze", inputs=lambda now, then: then),
        Fault(
            "inputs-nan",
            "its inputs are no numbers",
            inputs=lambda now, then: [math.nan] * len(now),
        ),
        Fault("killed", "it is killed", killed=True, ends=True),
    )
}


def changed(fault: Fault, heard: Heard) -> Heard | None:
    """Return what the arbiter gets of a message; its tick is when."""
    inside = START <= heard.tick < STOP
    return (fault.output or _same)(heard) if inside else heard
