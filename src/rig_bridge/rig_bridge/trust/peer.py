"""Either end of a link with a key: how two ends meet, and which packets are taken.

The bench asks with a fresh random number, the rig answers with one of its own, and both have the
keys of a new session. Neither number is secret or signed: who holds the key is shown by the first
packet whose tag fits. Until then the rig keeps to the session that it has (as WireGuard does), so
that nobody without the key can end one by asking.
"""

from __future__ import annotations

import os
from collections.abc import Callable

from rig_bridge.transport.packets import Order, PacketError
from rig_bridge.trust.session import End, Seal, Session, Verdict

PATIENCE = 10
"""Packets that the bench sends in a session of which it has heard nothing, until it asks again."""

REFUSALS = ("foreign", "replayed", "reordered", "stale", "after_hold")


class RefusedError(PacketError):
    """A packet that is not from this session, or not its next one."""


class Budget:
    """How many tags may fail where they are short: ``most``, of which a packet forgets ``drain``.

    Counted in packets, of which a thousand come in a second: the defaults forget one a second.
    """

    def __init__(self, most: float = 16.0, drain: float = 1e-3) -> None:
        self.most = most
        self.drain = drain
        self.level = 0.0

    def fail(self) -> bool:
        """Take a failure; return whether the budget is spent."""
        self.level += 1.0
        return self.level > self.most

    def pass_one(self) -> None:
        """Take a packet that was in order."""
        if self.level:
            self.level = max(self.level - self.drain, 0.0)


class Peer:
    """What both ends have in common. ``counts``: packets that were refused, by why."""

    end: End

    def __init__(
        self,
        key: bytes,
        nonce_bytes: int,
        budget: Budget | None = None,
        random: Callable[[int], bytes] = os.urandom,
    ) -> None:
        self.key = key
        self.nonce_bytes = nonce_bytes
        self.budget = budget
        self.random = random
        self.counts = dict.fromkeys(REFUSALS, 0)
        self.spent = False
        self.current: Session | None = None
        self.pending: Session | None = None
        self.previous: Session | None = None

    @property
    def sending(self) -> Session | None:
        """The session of what is sent."""
        return self.current

    def seal(self, body: bytes) -> Seal:
        """Return counter and tag of the next packet; there is a session (``sending``)."""
        session = self.sending
        assert session is not None
        return session.seal(body)

    def admit(self, body: bytes, seal: Seal) -> None:
        """Take a packet that has come, or raise RefusedError."""
        for session in (self.current, self.pending):
            if session is None:
                continue
            verdict = session.judge(body, seal)
            if verdict is Verdict.NEW:
                self._pass(session)
                return
            if verdict is not Verdict.FOREIGN:
                self._refuse(verdict.value, f"a packet was {verdict.value}")
        if self.previous is not None and self.previous.judge(body, seal) is not Verdict.FOREIGN:
            self._refuse("stale", "a packet of an earlier session came")
        self._fail()
        self._refuse("foreign", "a packet came whose tag does not fit the key")

    def _pass(self, session: Session) -> None:
        if session is not self.current:
            self.previous, self.current, self.pending = self.current, session, None
            self._met()
        if self.budget is not None:
            self.budget.pass_one()

    def _fail(self) -> None:
        met = self.current or self.pending
        if self.budget is None or met is None or not self.budget.fail():
            return
        self.spent = True
        self.current = self.pending = self.previous = None

    def _met(self) -> None:
        self.spent = False
        if self.budget is not None:
            self.budget.level = 0.0

    def _refuse(self, why: str, text: str) -> None:
        self.counts[why] += 1
        raise RefusedError(text)


class BenchPeer(Peer):
    """The bench's end: it asks for a meeting until a measurement of the new session comes."""

    end: End = "bench"

    def __init__(
        self,
        key: bytes,
        nonce_bytes: int,
        budget: Budget | None = None,
        random: Callable[[int], bytes] = os.urandom,
    ) -> None:
        super().__init__(key, nonce_bytes, budget, random)
        self.rounds = 0
        self.meet()

    @property
    def sending(self) -> Session | None:
        """The newest session: the bench is the one who begins it."""
        return self.pending or self.current

    def meet(self) -> None:
        """Begin a new meeting. Measurements of the present session are taken until it succeeds."""
        self.meeting = True
        self.nonce = self.random(self.nonce_bytes)
        self.pending = None
        self.tried = 0

    def greeting(self) -> bytes | None:
        """Return the random number to send now, if any; called for each packet."""
        if not self.meeting and self.current is not None:
            return None
        if self.pending is not None and self.tried < PATIENCE:
            self.tried += 1
            return None
        if self.pending is not None or not self.meeting:
            self.rounds += self.meeting
            self.meet()
        return self.nonce

    def hear(self, nonce: bytes) -> None:
        """Take the rig's random number."""
        if self.meeting and self.pending is None:
            self.pending = Session(self.key, self.nonce, nonce, self.end)
            self.tried = 0

    def unmet(self) -> str | None:
        """Return why there is no session; None where there is one."""
        if not self.meeting:
            return None
        if self.rounds or self.pending is not None:
            return "the rig answers, but no packet fits: has it the same key?"
        return "the rig does not answer the bench's question: has it a key, and is it on?"

    def _met(self) -> None:
        super()._met()
        self.meeting = False
        self.rounds = 0


class RigPeer(Peer):
    """The rig's end. In a session that was told to hold, nothing else is obeyed any more."""

    end: End = "rig"

    def hear(self, nonce: bytes) -> bytes:
        """Take the bench's random number; return the one to answer."""
        answer = self.random(self.nonce_bytes)
        self.pending = Session(self.key, nonce, answer, self.end)
        return answer

    def obeys(self, order: Order) -> bool:
        """Return whether the packet that has just been admitted counts; ``order``: what it says."""
        session = self.current
        assert session is not None
        session.held = session.held or order is Order.HOLD
        if session.held and order is not Order.HOLD:
            self.counts["after_hold"] += 1
            return False
        return True
