"""The CAN link: python-can's buses below, the DBC file's frames above."""

from __future__ import annotations

import logging
from collections.abc import Callable, Sequence
from pathlib import Path
from time import monotonic
from typing import Any, TypeVar

import can

from rig_bridge.rig_file import RigFile
from rig_bridge.transport.assembly import Assembly, describe
from rig_bridge.transport.can_bus import BusError, CanBuses
from rig_bridge.transport.can_codec import CanCodec, CanFrame
from rig_bridge.transport.can_layout import Bus
from rig_bridge.transport.can_options import switches
from rig_bridge.transport.dbc import load_dbc
from rig_bridge.transport.meeting import Meeting
from rig_bridge.transport.packets import Demand, Frame, OwnFrameError, PacketError
from rig_bridge.transport.settings import CanSettings, several
from rig_bridge.trust.peer import Peer
from steering_core.errors import BenchError

Packet = TypeVar("Packet")
# A server that is not there yet is worth one line at the end, not one for each attempt.
logging.getLogger("can.interfaces.socketcand").setLevel(logging.ERROR)
MOST_AT_ONCE = 1000
"""CAN frames taken in one go, so that a flooded bus cannot keep the loop from its tick."""


def described(settings: Sequence[CanSettings], dbc: Path) -> list[Bus]:
    """Return the buses with the files that describe them; ``dbc``: the rig's, others lie beside it.

    Each file is read once. Raises BenchError.
    """
    names = [(one.name, one.host, one.port) for one in settings]
    twice = next((name for index, name in enumerate(names) if name in names[:index]), None)
    if twice is not None:
        raise BenchError(f"links.can: the bus {twice[0]} is there twice")
    paths = [dbc if one.dbc is None else dbc.parent / one.dbc for one in settings]
    read = {path: load_dbc(path) for path in dict.fromkeys(paths)}
    return [
        Bus(one.name, read[path], one.fd, one.messages, switches(one))
        for one, path in zip(settings, paths, strict=True)
    ]


class CanLink:
    """Either end of a CAN link; ``dbc`` is the path of the DBC file.

    The same code opens a CAN interface of the kernel (socketcan), one behind a socketcand server,
    and any other that python-can knows; one bus or several. Whoever shares a bus is passed over;
    a frame that only looks like one of the rig's is counted in ``bad``, as are error frames. key:
    of the rig; without one whoever is on the bus is believed.
    """

    def __init__(
        self,
        rig: RigFile,
        settings: CanSettings | Sequence[CanSettings],
        dbc: Path,
        rig_end: bool = False,
        key: bytes | None = None,
    ) -> None:
        buses: Sequence[CanSettings] = several(settings)
        self.codec = CanCodec(rig, described(buses, dbc), key, rig_end)
        self.meeting = Meeting(
            self.codec.peer, lambda nonce: self._send([self.codec.greeting(nonce)])
        )
        self.sequence_bits = self.codec.sequence_bits
        self.bad = 0
        self.problem: str | None = None
        self.up = True
        self.awaited: Assembly = self.codec.from_rig
        self.buses = CanBuses(buses)

    @property
    def peer(self) -> Peer | None:
        """The other end as the key tells it; None on a link without one."""
        return self.codec.peer

    def meet(self) -> None:
        """Begin a new session, if the link has a key; bench's end."""
        self.meeting.begin()

    def unheard(self) -> str | None:
        """Which frames have not come since the last whole packet; None if all have."""
        return self.meeting.unmet() or describe(self.awaited.unheard()) or None

    def receive_frames(self, timeout_s: float) -> list[Frame]:
        """Return the measurements that have come."""
        self.awaited = self.codec.from_rig
        return self._receive(self.codec.take_frame, timeout_s)

    def receive_demands(self, timeout_s: float) -> list[Demand]:
        """Return the commands that have come."""
        self.awaited = self.codec.from_bench
        demands = self._receive(self._obeyed, timeout_s)
        self.meeting.answer()
        return demands

    def send_frame(self, frame: Frame) -> None:
        """Send measurements; nothing before the bench has met the rig."""
        if self.meeting.lets_out():
            self._send(self.codec.pack_frame(frame))

    def send_demand(self, demand: Demand) -> None:
        """Send commands, or the question that begins a session."""
        if self.meeting.lets_out(demand.order):
            self._send(self.codec.pack_demand(demand))

    def close(self) -> None:
        """Leave the buses."""
        self.buses.close()

    def _obeyed(self, *frame: Any) -> Demand | None:
        return self.meeting.obeyed(self.codec.take_demand(*frame))

    def _receive(self, take: Callable[..., Packet | None], timeout_s: float) -> list[Packet]:
        packets: list[Packet] = []
        # Frames of others come meanwhile, and must not make the wait longer.
        until = monotonic() + timeout_s
        wait = max(timeout_s, 0.0)
        for _ in range(MOST_AT_ONCE):
            try:
                come = self.buses.receive(wait)
            except BusError as error:
                self.up, self.problem = False, str(error)
                return packets
            if come is None:
                return packets
            packet = self._taken(take, *come)
            if packet is not None:
                packets.append(packet)
            wait = 0.0 if packets else max(until - monotonic(), 0.0)
        return packets

    def _taken(
        self, take: Callable[..., Packet | None], bus: int, message: can.Message
    ) -> Packet | None:
        if message.is_error_frame:
            self._note(bus, f"error frame (0x{message.arbitration_id:X})")
            return None
        number, extended = message.arbitration_id, message.is_extended_id
        if message.is_remote_frame:
            if (name := self.codec.name_of((bus, number, extended))) is not None:
                self._note(bus, f"somebody asks for {name} by a remote frame")
            return None
        frame = number, bytes(message.data), extended, message.is_fd, bus
        try:
            nonce = self.codec.take_greeting(*frame)
            if nonce is not None:
                self.meeting.hear(nonce)
                return None
            packet = take(*frame)
        except OwnFrameError as error:
            if message.is_rx and not self.buses.echoing[bus]:  # else its own echo
                self._note(bus, str(error))
            return None
        except PacketError as error:
            self._note(bus, str(error))
            self.up = self.up and not (self.peer is not None and self.peer.spent)
            return None
        self.up = self.up or packet is not None
        return packet

    def _note(self, bus: int, text: str) -> None:
        self.bad += 1
        self.problem = f"CAN bus {self.buses.names[bus]}: {text}"

    def _send(self, frames: Sequence[CanFrame]) -> None:
        try:
            self.buses.send(frames)
        except BusError as error:
            self.up, self.problem = False, str(error)
