"""What a transport has to offer: the one small interface between guard or rig and a link."""

from __future__ import annotations

from typing import Protocol

from rig_bridge.transport.packets import Demand, Frame
from rig_bridge.trust.peer import Peer


class Link(Protocol):
    """Either end of a link. ``receive_*`` wait for one packet, then give all that are there.

    Bytes that are no packet of this rig are dropped and counted in ``bad``; ``problem`` says what
    was wrong with the last of them. ``up`` is False while it is known that nobody is there.
    ``peer``: what is known of the other end, where the link has a key; nothing is sent or taken
    then but in a session.
    """

    sequence_bits: int
    bad: int
    problem: str | None
    up: bool

    @property
    def peer(self) -> Peer | None:
        """The other end as the key tells it; None on a link without one."""

    def meet(self) -> None:
        """Begin a new session, if the link has a key; bench's end."""

    def unheard(self) -> str | None:
        """Return what has not come since the last whole packet, where the link can tell."""

    def receive_frames(self, timeout_s: float) -> list[Frame]:
        """Return the rig's measurements that have come; bench's end."""

    def send_demand(self, demand: Demand) -> None:
        """Send commands to the rig; bench's end."""

    def receive_demands(self, timeout_s: float) -> list[Demand]:
        """Return the bench's commands that have come; rig's end."""

    def send_frame(self, frame: Frame) -> None:
        """Send measurements to the bench; rig's end."""

    def close(self) -> None:
        """Release the socket or the bus."""
