"""The binary frame of the UDP link: header, raw numbers by slot, CRC-32. Little-endian.

| bytes | what |
|---|---|
| 2 | "SR" |
| 1 | version, 1 |
| 1 | 1: measurements, 2: commands |
| 4 | signature of the channel table |
| 4 | sequence number |
| 8 | measurements: rig's clock in ns; commands: sequence number that they answer |
| 1 | measurements: 1 in the rig's safe state; commands: the order |
| | raw numbers, by slot, of the types in the channel table |
| 4 | CRC-32 (zlib) of everything before |

With a key there follow the packet's counter (8 bytes) and its tag (8 bytes) over counter and all of
the above. The datagrams of a meeting are "SM", version, 1 from the bench or 2 from the rig, and 16
random bytes.
"""

from __future__ import annotations

import struct
from collections.abc import Sequence
from zlib import crc32

from rig_bridge.channels import Channel
from rig_bridge.conversion import raw_of, si_of
from rig_bridge.raw_types import RAW_TYPES, decoded, encoded
from rig_bridge.rig_file import RigFile
from rig_bridge.transport.packets import Demand, Frame, PacketError, order_of
from rig_bridge.transport.signature import signature
from rig_bridge.trust.peer import BenchPeer, Peer, RigPeer
from rig_bridge.trust.session import Seal
from steering_core.errors import BenchError

HEADER = struct.Struct("<2sBBIIqB")
CRC = struct.Struct("<I")
MAGIC, VERSION = b"SR", 1
MEASURED, COMMANDED = 1, 2
SEQUENCES = 1 << 32
SEAL = struct.Struct("<QQ")
MEETING, NONCE_BYTES = b"SM", 16
GREETING = struct.Struct(f"<2sBB{NONCE_BYTES}s")
FROM = {"bench": 1, "rig": 2}


class _Numbers:
    """SI values of the channels ``names`` as raw numbers in slot order, and back."""

    def __init__(self, rig: RigFile, names: Sequence[str]) -> None:
        places = {name: rig.channels[name].udp for name in names}
        missing = next((name for name, place in places.items() if place is None), None)
        if missing is not None:
            raise BenchError(f"channel '{missing}' has no place on the UDP link (udp: {{slot: n}})")
        slots = {name: place.slot for name, place in places.items() if place is not None}
        kinds = {name: RAW_TYPES[place.raw] for name, place in places.items() if place is not None}
        self.order = sorted(names, key=slots.__getitem__)
        if [slots[name] for name in self.order] != list(range(len(names))):
            raise BenchError(f"UDP slots must be 0 to {len(names) - 1}, each once: {slots}")
        self.struct = struct.Struct("<" + "".join(kinds[name].code for name in self.order))
        self.index = [names.index(name) for name in self.order]
        self.kinds = [kinds[name] for name in self.order]
        self.channels: list[Channel] = rig.rows(self.order)

    def pack(self, values: Sequence[float]) -> bytes:
        rows = zip(self.index, self.kinds, self.channels, strict=True)
        return self.struct.pack(*(encoded(k, raw_of(c, values[i])) for i, k, c in rows))

    def unpack(self, data: bytes) -> tuple[float, ...]:
        values = [0.0] * len(self.order)
        rows = zip(self.struct.unpack(data), self.index, self.kinds, self.channels, strict=True)
        for raw, index, kind, channel in rows:
            values[index] = si_of(channel, decoded(kind, raw))
        return tuple(values)


class UdpCodec:
    """Packets of one rig as bytes. ``unpack_*`` raise PacketError, which says what does not fit.

    key: of the rig, None for a link without one. rig_end: which end this is, for the key.
    """

    sequence_bits = 32

    def __init__(self, rig: RigFile, key: bytes | None = None, rig_end: bool = False) -> None:
        kind = RigPeer if rig_end else BenchPeer
        self.peer: Peer | None = None if key is None else kind(key, NONCE_BYTES)
        self.signature = signature(rig)
        self.numbers = {
            MEASURED: _Numbers(rig, rig.measured),
            COMMANDED: _Numbers(rig, rig.commanded),
        }

    def pack_frame(self, frame: Frame) -> bytes:
        """Return the datagram of the rig's measurements."""
        head = frame.sequence, frame.rig_ns, frame.rig_safe
        return self._sealed(self._pack(MEASURED, *head, frame.values))

    def unpack_frame(self, data: bytes) -> Frame:
        """Return the measurements of a datagram."""
        sequence, rig_ns, rig_safe, values = self._unpack(MEASURED, self._opened(data))
        return Frame(sequence, rig_ns, values, bool(rig_safe))

    def pack_demand(self, demand: Demand) -> bytes:
        """Return the datagram of the bench's commands."""
        head = demand.sequence, demand.answers, demand.order
        return self._sealed(self._pack(COMMANDED, *head, demand.values))

    def unpack_demand(self, data: bytes) -> Demand:
        """Return the commands of a datagram."""
        sequence, answers, order, values = self._unpack(COMMANDED, self._opened(data))
        return Demand(sequence, answers, order_of(order), values)

    def greeting(self, nonce: bytes) -> bytes:
        """Return the datagram of this end's part in a meeting."""
        assert self.peer is not None
        return GREETING.pack(MEETING, VERSION, FROM[self.peer.end], nonce)

    def take_greeting(self, data: bytes) -> bytes | None:
        """Return the random bytes of the other end's part in a meeting; None for anything else."""
        if self.peer is None or len(data) != GREETING.size:
            return None
        magic, version, end, nonce = GREETING.unpack(data)
        ours = magic == MEETING and version == VERSION and end != FROM[self.peer.end]
        return bytes(nonce) if ours else None

    def _sealed(self, data: bytes) -> bytes:
        if self.peer is None:
            return data
        seal = self.peer.seal(data)
        return data + SEAL.pack(seal.counter, seal.tag)

    def _opened(self, data: bytes) -> bytes:
        if self.peer is None:
            return data
        if len(data) < SEAL.size:
            raise PacketError(f"{len(data)} bytes that are no frame of a rig")
        body = data[: -SEAL.size]
        self.peer.admit(body, Seal(*SEAL.unpack_from(data, len(body))))
        return body

    def _pack(
        self, kind: int, sequence: int, stamp: int, flag: int, values: Sequence[float]
    ) -> bytes:
        head = (MAGIC, VERSION, kind, self.signature, sequence % SEQUENCES, stamp, flag)
        body = HEADER.pack(*head) + self.numbers[kind].pack(values)
        return body + CRC.pack(crc32(body))

    def _unpack(self, wanted: int, data: bytes) -> tuple[int, int, int, tuple[float, ...]]:
        if data[:2] == MEETING:
            raise PacketError("the other end has a key and wants to meet: this one has none")
        if len(data) < HEADER.size + CRC.size or data[:2] != MAGIC:
            raise PacketError(f"{len(data)} bytes that are no frame of a rig")
        if CRC.unpack(data[-CRC.size :])[0] != crc32(data[: -CRC.size]):
            raise PacketError("wrong checksum")
        _, version, kind, table, sequence, stamp, flag = HEADER.unpack_from(data)
        if version != VERSION:
            raise PacketError(f"frame of version {version}, this is {VERSION}")
        if kind != wanted:
            raise PacketError("frame of the other direction")
        body = data[HEADER.size : -CRC.size]
        if table != self.signature or len(body) != self.numbers[kind].struct.size:
            raise PacketError("the other end has another channel table")
        return sequence, stamp, flag, self.numbers[kind].unpack(body)
