"""The frames of a CAN link with a key: one that authenticates a packet's others, one for a meeting.

``RigTag`` and ``BenchTag`` have ``Counter`` as all frames of a packet, ``Fresh``, the low bits of a
counter that never repeats in a session, and ``Tag``, the low bits of the tag over the data of the
packet's other frames, in their order, and that counter. ``RigMeet`` and ``BenchMeet`` have
``Nonce``, an end's random number. With 44 bits of tag a guess fits once in 1.8e13; the budget lets
through some sixteen guesses at once and one a second, so one of a day's fits with 5e-9.
"""

from __future__ import annotations

from typing import Any

from rig_bridge.transport.can_fields import bits, check_whole
from rig_bridge.transport.can_layout import Layout
from rig_bridge.transport.can_whole import WholeNumbers
from rig_bridge.transport.packets import PacketError
from rig_bridge.trust.session import TAG_BITS, Seal
from steering_core.errors import BenchError

LEAST = {"Counter": 3, "Fresh": 8, "Tag": 24}
"""Least bits: a tag and freshness of so many are what AUTOSAR's SecOC profile 1 has."""

LEAST_NONCE = 48
TAGS = {"rig": "RigTag", "bench": "BenchTag"}
MEETS = {"rig": "RigMeet", "bench": "BenchMeet"}
NAMES = (*TAGS.values(), *MEETS.values())


class TagFrame:
    """The frame with the tag of one direction; ``sender``: whose."""

    def __init__(self, sender: str, layout: Layout) -> None:
        self.slot = _slot(TAGS[sender], layout)
        check_whole(self.slot.message, LEAST)
        self.key = self.slot.key
        self.fresh_bits = _checked(self.slot.message, "Fresh")
        self.tag_bits = _checked(self.slot.message, "Tag")
        self.numbers = WholeNumbers(self.slot.message, LEAST, self.slot.length)

    def encode(self, seal: Seal, counter: int) -> bytes:
        """Return the data of the frame; counter and tag are cut to what it holds."""
        return self.numbers.encode({"Counter": counter, "Fresh": seal.counter, "Tag": seal.tag})

    def seal(self, signals: Any) -> Seal:
        """Return the seal of a frame's signals."""
        return Seal(signals["Fresh"], signals["Tag"], self.fresh_bits, self.tag_bits)


class MeetFrame:
    """The frame with the random number of one end; ``sender``: whose."""

    def __init__(self, sender: str, layout: Layout) -> None:
        self.slot = _slot(MEETS[sender], layout)
        check_whole(self.slot.message, {"Nonce": LEAST_NONCE})
        self.key = self.slot.key
        self.nonce_bytes = bits(self.slot.message, "Nonce") // 8
        self.numbers = WholeNumbers(self.slot.message, ("Nonce",), self.slot.length)

    def encode(self, nonce: bytes) -> bytes:
        """Return the data of the frame."""
        return self.numbers.encode({"Nonce": int.from_bytes(nonce, "little")})

    def decode(self, data: bytes, fd: bool) -> bytes:
        """Return the random number; raises PacketError."""
        if len(data) != self.slot.length or fd is not self.slot.fd:
            raise PacketError(f"{self.slot.message.name} came with {len(data)} bytes")
        nonce = self.numbers.decode(data)["Nonce"] & (1 << 8 * self.nonce_bytes) - 1
        return nonce.to_bytes(self.nonce_bytes, "little")


def _slot(name: str, layout: Layout) -> Any:
    try:
        return layout.slot(name)
    except BenchError as error:
        raise BenchError(
            f"{error} (a rig with a key has {', '.join(NAMES)}; one that checks none: "
            "authentication: none)"
        ) from None


def _checked(message: Any, name: str) -> int:
    width = bits(message, name)
    if width > TAG_BITS:
        raise BenchError(
            f"the DBC file does not fit: {message.name}.{name} has over {TAG_BITS} bits"
        )
    return width
