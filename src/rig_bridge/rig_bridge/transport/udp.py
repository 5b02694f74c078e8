"""The UDP link: one datagram a tick in each direction."""

from __future__ import annotations

import select
import socket
from collections.abc import Callable
from time import monotonic
from typing import TypeVar

from rig_bridge.rig_file import RigFile
from rig_bridge.transport.meeting import Meeting
from rig_bridge.transport.packets import Demand, Frame, PacketError
from rig_bridge.transport.settings import UdpSettings, address
from rig_bridge.transport.udp_codec import UdpCodec
from rig_bridge.trust.peer import Peer
from steering_core.errors import BenchError

Packet = TypeVar("Packet")
LARGEST = 2048
MOST_AT_ONCE = 1000
"""Datagrams taken in one go, so that a flood cannot keep the loop from its tick."""


class UdpLink:
    """Talks to one peer only; a datagram from elsewhere never gets here.

    ``up`` becomes False when the peer's machine answers that nobody listens there. key: of the
    rig; without one whoever uses the peer's address is believed.
    """

    sequence_bits = UdpCodec.sequence_bits

    def __init__(
        self,
        rig: RigFile,
        settings: UdpSettings,
        rig_end: bool = False,
        key: bytes | None = None,
    ) -> None:
        self.codec = UdpCodec(rig, key, rig_end)
        self.meeting = Meeting(
            self.codec.peer, lambda nonce: self._send(self.codec.greeting(nonce))
        )
        self.bad = 0
        self.problem: str | None = None
        self.up = True
        here, there = settings.bench, settings.rig
        here, there = (there, here) if rig_end else (here, there)
        self.socket = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
        try:
            self.socket.bind(address(here))
            self.socket.connect(address(there))
        except OSError as error:
            self.socket.close()
            raise BenchError(f"cannot open the UDP link {here} to {there}: {error}") from None
        self.socket.setblocking(False)

    @property
    def peer(self) -> Peer | None:
        """The other end as the key tells it; None on a link without one."""
        return self.codec.peer

    def meet(self) -> None:
        """Begin a new session, if the link has a key; bench's end."""
        self.meeting.begin()

    def receive_frames(self, timeout_s: float) -> list[Frame]:
        """Return the measurements that have come."""
        return self._receive(self.codec.unpack_frame, timeout_s)

    def receive_demands(self, timeout_s: float) -> list[Demand]:
        """Return the commands that have come."""
        demands = self._receive(self._obeyed, timeout_s)
        self.meeting.answer()
        return [demand for demand in demands if demand is not None]

    def unheard(self) -> str | None:
        """Return why nothing comes, where that is known: a packet comes whole or not at all."""
        return self.meeting.unmet()

    def send_frame(self, frame: Frame) -> None:
        """Send measurements; nothing before the bench has met the rig."""
        if self.meeting.lets_out():
            self._send(self.codec.pack_frame(frame))

    def send_demand(self, demand: Demand) -> None:
        """Send commands, or the question that begins a session."""
        if self.meeting.lets_out(demand.order):
            self._send(self.codec.pack_demand(demand))

    def close(self) -> None:
        """Close the socket."""
        self.socket.close()

    def _obeyed(self, data: bytes) -> Demand | None:
        return self.meeting.obeyed(self.codec.unpack_demand(data))

    def _receive(self, unpack: Callable[[bytes], Packet], timeout_s: float) -> list[Packet]:
        packets: list[Packet] = []
        # What is no packet comes meanwhile, and must neither cut the wait short nor make it longer.
        until = monotonic() + timeout_s
        select.select([self.socket], [], [], max(timeout_s, 0.0))
        for _ in range(MOST_AT_ONCE):
            try:
                data = self.socket.recv(LARGEST)
            except OSError as error:
                if not isinstance(error, BlockingIOError):
                    self.up, self.problem = False, f"{error.strerror}"
                rest = until - monotonic()
                if packets or rest <= 0.0:
                    return packets
                select.select([self.socket], [], [], rest)
                continue
            nonce = self.codec.take_greeting(data)
            if nonce is not None:
                self.meeting.hear(nonce)
                continue
            try:
                packets.append(unpack(data))
                self.up = True
            except PacketError as error:
                self.bad += 1
                self.problem = str(error)
        return packets

    def _send(self, data: bytes) -> None:
        try:
            self.socket.send(data)
        except BlockingIOError:
            self.problem = "the network does not take the frames fast enough"
        except OSError as error:
            self.up, self.problem = False, f"{error.strerror}"
