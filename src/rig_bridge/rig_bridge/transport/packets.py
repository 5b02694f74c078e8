"""What goes over a link in each direction; values are SI, in the order of the rig's table."""

from __future__ import annotations

from enum import IntEnum
from typing import NamedTuple

from rig_bridge.safety.frame_watch import Frame

__all__ = ["Demand", "Frame", "Order", "OwnFrameError", "PacketError", "order_of"]


class Order(IntEnum):
    """What the bench wants of the rig. Only ``ARM`` ends a safe state that the rig has latched."""

    HOLD = 0
    ARM = 1
    RUN = 2


class Demand(NamedTuple):
    """Commands to the rig. ``answers``: the sequence number of the newest measurement used."""

    sequence: int
    answers: int
    order: Order
    values: tuple[float, ...]


class PacketError(ValueError):
    """Bytes that are no packet of this rig; the text says why."""


class OwnFrameError(PacketError):
    """A frame that only this end sends: its own echo, or somebody else's."""


def order_of(number: int) -> Order:
    """Return the order of a received number; raises PacketError."""
    try:
        return Order(number)
    except ValueError:
        raise PacketError(f"unknown order {number}") from None
