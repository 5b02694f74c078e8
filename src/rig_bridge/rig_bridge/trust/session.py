"""One session: tags under keys of its own, and a counter in each direction that only rises.

The keys come from the rig's key and a fresh random number of each end, so that nothing recorded in
one session fits another. Tags are keyed BLAKE2s (RFC 7693), cut to what the link carries; cutting
them and sending only the low bits of the counter is as in AUTOSAR's SecOC. The window that tells a
repetition from a packet that was overtaken is IPsec's (RFC 4303, 3.4.3).
"""

from __future__ import annotations

import struct
from enum import Enum
from hashlib import blake2s
from typing import Literal, NamedTuple

End = Literal["bench", "rig"]
TAG_BITS = 64
COUNTS = 1 << 64
WINDOW = 64
"""Packets of which is known whether they have come."""

_COUNTER = struct.Struct("<Q")


class Verdict(Enum):
    """What a packet is to a session."""

    NEW = "new"
    REPLAYED = "replayed"
    REORDERED = "reordered"
    FOREIGN = "foreign"


class Seal(NamedTuple):
    """What goes along with a packet: the counter's low bits and the tag's, and how many."""

    counter: int
    tag: int
    counter_bits: int = TAG_BITS
    tag_bits: int = TAG_BITS


class Session:
    """Seals what this end sends and judges what comes.

    key: the rig's. bench_nonce, rig_nonce: the random numbers of both ends. end: which one is here.
    """

    def __init__(self, key: bytes, bench_nonce: bytes, rig_nonce: bytes, end: End) -> None:
        secret = blake2s(bench_nonce + rig_nonce, key=key, person=b"session").digest()
        other = "rig" if end == "bench" else "bench"
        self._ours = _tagger(secret, end)
        self._theirs = _tagger(secret, other)
        self.sent = 0
        self.last = -1
        self.seen = 0
        self.held = False

    def seal(self, body: bytes) -> Seal:
        """Return counter and tag of the next packet."""
        counter = self.sent
        self.sent += 1
        return Seal(counter, _tag(self._ours, counter, body))

    def judge(self, body: bytes, seal: Seal) -> Verdict:
        """Return what a packet is. Only a new one moves the counter."""
        expected = self.last + 1
        size = 1 << seal.counter_bits
        ahead = expected + (seal.counter - expected & size - 1)
        if self._fits(ahead, body, seal):
            self._note(ahead)
            return Verdict.NEW
        behind = ahead - size
        if not self._fits(behind, body, seal):
            return Verdict.FOREIGN
        age = self.last - behind
        known = age >= WINDOW or self.seen >> age & 1
        return Verdict.REPLAYED if known else Verdict.REORDERED

    def _fits(self, counter: int, body: bytes, seal: Seal) -> bool:
        if not 0 <= counter < COUNTS:
            return False
        # All bits at once: how long it takes says nothing of where the first wrong one is.
        wrong = _tag(self._theirs, counter, body) ^ seal.tag
        return wrong & (1 << seal.tag_bits) - 1 == 0

    def _note(self, counter: int) -> None:
        passed = counter - self.last
        self.seen = 1 if passed >= WINDOW else (self.seen << passed | 1) & (1 << WINDOW) - 1
        self.last = counter


def _tagger(secret: bytes, end: str) -> blake2s:
    key = blake2s(end.encode(), key=secret).digest()
    return blake2s(key=key, digest_size=TAG_BITS // 8)


def _tag(tagger: blake2s, counter: int, body: bytes) -> int:
    made = tagger.copy()
    made.update(_COUNTER.pack(counter) + body)
    return int.from_bytes(made.digest(), "little")
