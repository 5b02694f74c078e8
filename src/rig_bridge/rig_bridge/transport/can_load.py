"""How much of a CAN bus frames take at worst, whatever is in them.

Classic CAN: R. I. Davis, A. Burns, R. J. Bril, J. J. Lukkien, "Controller Area Network (CAN)
schedulability analysis: Refuted, revisited and revised", Real-Time Systems 35 (2007), eq. (1):
g + 8 s + 13 + floor((g + 8 s - 1) / 4) bits for s bytes, g being 34 (11 bits) or 54 (29 bits).

CAN FD: fields of ISO 11898-1:2015, 10.4 and 10.5. Stuffing by the same rule goes to the end of
the data; the CRC field with its stuff count has a stuff bit before it and after each fourth bit.
What lies between BRS and CRC delimiter is sent at the rate of the data phase.
"""

from __future__ import annotations

from collections.abc import Iterable
from typing import NamedTuple

from rig_bridge.signals import PERIOD_S
from rig_bridge.transport.can_options import Rates

STUFFED = {False: 34, True: 54}
"""Bits of a classic frame beside the data that are stuffed, by whether it has 29 bits."""

UNSTUFFED = 13
"""CRC delimiter, acknowledgement, end of frame (7), space between frames (3); also of CAN FD."""

ARBITRATION = {False: 17, True: 36}
"""Bits of a CAN FD frame from its start to BRS, by whether it has 29 bits."""

CONTROL = 5
"""ESI and length code."""

STUFF_COUNT, CRC_SHORT, CRC_LONG, LONGEST_SHORT = 4, 17, 21, 16
"""Bits of the stuff count and of the CRC of up to 16 bytes and of more."""


class FrameShape(NamedTuple):
    """``length``: bytes of data as sent."""

    length: int
    extended: bool
    fd: bool = False
    switched: bool = False


class Bits(NamedTuple):
    """Bits of a frame, the space after it included, at either rate."""

    nominal: int
    data: int


def worst_bits(shape: FrameShape) -> Bits:
    """Return how many bits a frame has at most."""
    if not shape.fd:
        stuffed = STUFFED[shape.extended] + 8 * shape.length
        return Bits(stuffed + _stuffing(stuffed) + UNSTUFFED, 0)
    before, data = ARBITRATION[shape.extended], CONTROL + 8 * shape.length
    check = STUFF_COUNT + (CRC_SHORT if shape.length <= LONGEST_SHORT else CRC_LONG)
    slow = before + _stuffing(before) + UNSTUFFED
    fast = data + _stuffing(before + data) - _stuffing(before) + check + 1 + check // 4
    return Bits(slow, fast) if shape.switched else Bits(slow + fast, 0)


def _stuffing(bits: int) -> int:
    return (bits - 1) // 4


def worst_load(shapes: Iterable[FrameShape], rates: Rates) -> float:
    """Return the share of a bus that these frames take at most, each once in a tick."""
    bits = [worst_bits(shape) for shape in shapes]
    slow, fast = sum(b.nominal for b in bits), sum(b.data for b in bits)
    return (slow / rates.nominal + fast / rates.data) / PERIOD_S
