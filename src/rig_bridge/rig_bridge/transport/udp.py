"""The UDP link: one datagram a tick in each direction."""

from __future__ import annotations

import select
import socket
from collections.abc import Callable
from time import monotonic
from typing import TypeVar

from rig_bridge.rig_file import RigFile
from rig_bridge.transport.packets import Demand, Frame, PacketError
from rig_bridge.transport.settings import UdpSettings, address
from rig_bridge.transport.udp_codec import UdpCodec
from steering_core.errors import BenchError

Packet = TypeVar("Packet")
LARGEST = 2048


class UdpLink:
    """Talks to one peer only; a datagram from elsewhere never gets here.

    ``up`` becomes False when the peer's machine answers that nobody listens there.
    """

    sequence_bits = UdpCodec.sequence_bits

    def __init__(self, rig: RigFile, settings: UdpSettings, rig_end: bool = False) -> None:
        self.codec = UdpCodec(rig)
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

    def receive_frames(self, timeout_s: float) -> list[Frame]:
        """Return the measurements that have come."""
        return self._receive(self.codec.unpack_frame, timeout_s)

    def receive_demands(self, timeout_s: float) -> list[Demand]:
        """Return the commands that have come."""
        return self._receive(self.codec.unpack_demand, timeout_s)

    def unheard(self) -> str | None:
        """Return nothing: a packet comes whole or not at all."""
        return None

    def send_frame(self, frame: Frame) -> None:
        """Send measurements."""
        self._send(self.codec.pack_frame(frame))

    def send_demand(self, demand: Demand) -> None:
        """Send commands."""
        self._send(self.codec.pack_demand(demand))

    def close(self) -> None:
        """Close the socket."""
        self.socket.close()

    def _receive(self, unpack: Callable[[bytes], Packet], timeout_s: float) -> list[Packet]:
        packets: list[Packet] = []
        until = monotonic() + timeout_s
        select.select([self.socket], [], [], max(timeout_s, 0.0))
        while True:
            try:
                data = self.socket.recv(LARGEST)
            except BlockingIOError:
                return packets
            except OSError as error:
                # The answer that nobody listens comes at once; the wait is for somebody who does.
                self.up, self.problem = False, f"{error.strerror}"
                rest = until - monotonic()
                if rest <= 0.0:
                    return packets
                select.select([self.socket], [], [], rest)
                continue
            try:
                packets.append(unpack(data))
                self.up = True
            except PacketError as error:
                self.bad += 1
                self.problem = str(error)

    def _send(self, data: bytes) -> None:
        try:
            self.socket.send(data)
        except BlockingIOError:
            self.problem = "the network does not take the frames fast enough"
        except OSError as error:
            self.up, self.problem = False, f"{error.strerror}"
