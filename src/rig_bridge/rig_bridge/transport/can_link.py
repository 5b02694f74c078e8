"""The CAN link: python-can's bus below, the DBC file's frames above."""

from __future__ import annotations

import logging
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import TypeVar

import can

from rig_bridge.rig_file import RigFile
from rig_bridge.transport.can_codec import CanCodec, CanFrame
from rig_bridge.transport.dbc import load_dbc
from rig_bridge.transport.packets import Demand, Frame, PacketError
from rig_bridge.transport.settings import CanSettings
from rig_bridge.transport.socketcand import open_bus, send_all
from steering_core.errors import BenchError

Packet = TypeVar("Packet")
# A frame cut in two by the TCP stream is put together again, and is not worth a line each.
logging.getLogger("can.interfaces.socketcand").setLevel(logging.ERROR)
MOST_AT_ONCE = 1000
"""CAN frames taken in one go, so that a flooded bus cannot keep the loop from its tick."""


class CanLink:
    """Either end of a CAN link; ``dbc`` is the path of the DBC file.

    The same code opens a CAN interface of the kernel (socketcan), one behind a socketcand server,
    and any other that python-can knows. Whoever shares the bus is passed over.
    """

    def __init__(self, rig: RigFile, settings: CanSettings, dbc: Path) -> None:
        self.codec = CanCodec(rig, load_dbc(dbc))
        self.sequence_bits = self.codec.sequence_bits
        self.bad = 0
        self.problem: str | None = None
        self.up = True
        try:
            self.bus = open_bus(settings.options())
        except (can.CanError, OSError, ValueError, NotImplementedError) as error:
            where = f"{settings.interface} {settings.channel}"
            raise BenchError(f"cannot open the CAN bus {where}: {error}") from None

    def receive_frames(self, timeout_s: float) -> list[Frame]:
        """Return the measurements that have come."""
        return self._receive(self.codec.take_frame, timeout_s)

    def receive_demands(self, timeout_s: float) -> list[Demand]:
        """Return the commands that have come."""
        return self._receive(self.codec.take_demand, timeout_s)

    def send_frame(self, frame: Frame) -> None:
        """Send measurements."""
        self._send(self.codec.pack_frame(frame))

    def send_demand(self, demand: Demand) -> None:
        """Send commands."""
        self._send(self.codec.pack_demand(demand))

    def close(self) -> None:
        """Leave the bus."""
        self.bus.shutdown()

    def _receive(
        self, take: Callable[[int, bytes], Packet | None], timeout_s: float
    ) -> list[Packet]:
        packets: list[Packet] = []
        wait = max(timeout_s, 0.0)
        for _ in range(MOST_AT_ONCE):
            try:
                message = self.bus.recv(wait)
            except (can.CanError, OSError) as error:
                self.up, self.problem = False, str(error)
                return packets
            if message is None:
                return packets
            packet = self._taken(take, message)
            if packet is not None:
                packets.append(packet)
                wait = 0.0
        return packets

    def _taken(
        self, take: Callable[[int, bytes], Packet | None], message: can.Message
    ) -> Packet | None:
        if message.is_error_frame or message.is_remote_frame:
            return None
        try:
            packet = take(message.arbitration_id, bytes(message.data))
        except PacketError as error:
            self.bad += 1
            self.problem = str(error)
            return None
        self.up = self.up or packet is not None
        return packet

    def _send(self, frames: Sequence[CanFrame]) -> None:
        messages = [
            can.Message(arbitration_id=number, data=data, is_extended_id=number > 0x7FF)
            for number, data in frames
        ]
        try:
            send_all(self.bus, messages)
        except (can.CanError, OSError) as error:
            self.up, self.problem = False, str(error)
