"""The sources: is a message a wish or a fault, is it fresh, and whose turn is it?

A message that is no number or out of range is refused: it does not count as heard, so a source
that goes on like that falls silent.
"""

from __future__ import annotations

import math
from typing import Any

from steering_core.compiled import kernel

ASKED, PRIORITY, MESSAGE_TICK = range(3)
"""Columns of the requests: torque [N m], priority, tick of the message (-1: none yet)."""

TORQUE, RANK, HEARD, SEEN, SILENT, BAD = range(6)
"""Columns of what is kept of a source: its last accepted torque [N m] and priority, the ticks of
that message and of the last one at all (-1: none), 1 while it is silent, 1 if the last was refused.
"""

LARGEST_PRIORITY = 1.0e6


@kernel
def believable(largest: float, torque: float, priority: float) -> bool:
    """Return whether a message is a wish; largest [N m]: torque beyond which it is a fault."""
    return abs(torque) <= largest and abs(priority) <= LARGEST_PRIORITY


@kernel
def message_tick(tick: int, delay: int, every: int) -> int:
    """Return the tick of the message that a member's input holds at ``tick``; -1: none yet."""
    if tick < delay:
        return -1
    return (tick - delay) // every * every


@kernel
def hear(p: Any, request: Any, kept: Any) -> int:
    """Take in one source's present message; return 1 if it is new and refused."""
    if request[MESSAGE_TICK] < 0.0 or request[MESSAGE_TICK] == kept[SEEN]:
        return 0
    kept[SEEN] = request[MESSAGE_TICK]
    torque, priority = request[ASKED], request[PRIORITY]
    believed = believable(p.out_of_range, torque, priority)
    kept[BAD] = 0.0 if believed else 1.0
    if not believed:
        return 1
    kept[TORQUE], kept[RANK], kept[HEARD] = torque, priority, request[MESSAGE_TICK]
    return 0


@kernel
def falls_silent(tick: int, longest: float, kept: Any) -> int:
    """Note whether a source is silent; return 1 if it became so at this tick.

    longest [ticks]: age up to which its last accepted message is fresh. A source that was never
    heard is not silent: it is not there.
    """
    silent = kept[HEARD] >= 0.0 and tick - kept[HEARD] > longest
    became = 1 if silent and kept[SILENT] == 0.0 else 0
    kept[SILENT] = 1.0 if silent else 0.0
    return became


@kernel
def served(kept: Any) -> int:
    """Return the number (from 0) of the source to be served, or -1.

    The greatest priority that is not negative among those that are heard; of equals the first.
    """
    best, rank = -1, -math.inf
    for i in range(kept.shape[0]):
        heard = kept[i, HEARD] >= 0.0 and kept[i, SILENT] == 0.0
        if heard and kept[i, RANK] >= 0.0 and kept[i, RANK] > rank:
            best, rank = i, kept[i, RANK]
    return best
