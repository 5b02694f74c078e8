"""What every link with a key does about meetings; how a nonce is sent is the link's own."""

from __future__ import annotations

from collections.abc import Callable

from rig_bridge.transport.packets import Demand, Order
from rig_bridge.trust.peer import BenchPeer, Peer, RigPeer


class Meeting:
    """Stands between a link and its packets. peer: None for a link without a key.

    send: sends a random number of this end.
    """

    def __init__(self, peer: Peer | None, send: Callable[[bytes], None]) -> None:
        self.peer = peer
        self.send = send
        self.asked: bytes | None = None

    def begin(self) -> None:
        """Begin a new session; bench's end."""
        if isinstance(self.peer, BenchPeer):
            self.peer.meet()

    def hear(self, nonce: bytes) -> None:
        """Take the other end's random number. The rig answers once it has read all that came."""
        if isinstance(self.peer, BenchPeer):
            self.peer.hear(nonce)
        else:
            self.asked = nonce

    def answer(self) -> None:
        """Answer the last one who asked, if anybody has; rig's end."""
        if self.asked is not None and isinstance(self.peer, RigPeer):
            self.send(self.peer.hear(self.asked))
        self.asked = None

    def lets_out(self, order: Order | None = None) -> bool:
        """Return whether a packet may be sent now; the bench may ask for a meeting in its place.

        order: of commands. The order to hold goes out beside the question, where a session is left.
        """
        peer = self.peer
        if peer is None:
            return True
        if isinstance(peer, BenchPeer) and (nonce := peer.greeting()) is not None:
            self.send(nonce)
            if order is not Order.HOLD:
                return False
        return peer.sending is not None

    def obeyed(self, demand: Demand | None) -> Demand | None:
        """Return commands that count; none but the order to hold after that order."""
        if demand is None or not isinstance(self.peer, RigPeer):
            return demand
        return demand if self.peer.obeys(demand.order) else None

    def unmet(self) -> str | None:
        """Return why there is no session; None where there is one, or no key."""
        return self.peer.unmet() if isinstance(self.peer, BenchPeer) else None
