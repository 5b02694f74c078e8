"""CAN frames of one rig, as the DBC file lays them out, to packets and back.

A packet is several CAN frames: those with the channels, and a status frame (``RigStatus`` from the
rig, ``BenchStatus`` to it). All carry the signal ``Counter``, the packet's sequence number modulo
its size; a packet is complete when every frame with its number has come. ``RigStatus`` has further
``Clock`` (us of the rig's clock) and ``Safe``, ``BenchStatus`` has ``Answers`` and ``Order``, and
both ``Table``, the low bits of the channel table's and DBC file's signature. A channel without a
value is sent as the lowest number of a signed signal, or the highest of an unsigned one.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from cantools.database.can import Database, Message

from rig_bridge.conversion import raw_of, si_of
from rig_bridge.rig_file import RigFile
from rig_bridge.transport.assembly import Assembly, Unwrapped
from rig_bridge.transport.can_fields import CanField, bits, check_signals, find_message
from rig_bridge.transport.dbc import layout_text
from rig_bridge.transport.packets import Demand, Frame, PacketError, order_of
from rig_bridge.transport.signature import signature
from steering_core.errors import BenchError

RIG_STATUS = ("RigStatus", ("Counter", "Clock", "Safe", "Table"))
BENCH_STATUS = ("BenchStatus", ("Counter", "Answers", "Order", "Table"))
CanFrame = tuple[int, bytes]


class _Direction:
    """The frames of one direction: CAN messages by identifier, and the channels in them."""

    def __init__(
        self,
        rig: RigFile,
        names: Sequence[str],
        database: Database,
        status: tuple[str, Sequence[str]],
    ) -> None:
        self.fields = [CanField(name, rig.channels[name], database) for name in names]
        self.status = find_message(database, status[0])
        check_signals(self.status, status[1])
        messages = {field.message.frame_id: field.message for field in self.fields}
        for message in messages.values():
            check_signals(message, ("Counter",))
        self.messages: dict[int, Message] = {**messages, self.status.frame_id: self.status}
        sizes = {bits(message, "Counter") for message in self.messages.values()}
        if len(sizes) > 1:
            raise BenchError(f"the Counter of {status[0]}'s frames must be equally wide everywhere")
        self.counter_bits = sizes.pop()
        self.table_mask = (1 << bits(self.status, "Table")) - 1

    def encode(self, values: Sequence[float], counter: int, **status: int) -> list[CanFrame]:
        """Return the CAN frames, the status last."""
        signals: dict[int, dict[str, int]] = {number: {} for number in self.messages}
        for field, value in zip(self.fields, values, strict=True):
            signals[field.message.frame_id][field.signal] = field.encoded(raw_of(field.row, value))
        signals[self.status.frame_id] |= status
        frames = []
        for number, message in self.messages.items():
            whole = {s.name: 0 for s in message.signals} | signals[number]
            whole["Counter"] = counter % (1 << self.counter_bits)
            frames.append((number, message.encode(whole, scaling=False, strict=False)))
        return frames

    def values(self, parts: Mapping[int, Mapping[str, int]]) -> tuple[float, ...]:
        """Return the SI values of a complete packet."""
        numbers = (f.decoded(parts[f.message.frame_id][f.signal]) for f in self.fields)
        return tuple(si_of(f.row, raw) for f, raw in zip(self.fields, numbers, strict=True))


class CanCodec:
    """Packets of one rig as CAN frames. ``take_*`` give a packet once its last frame has come."""

    def __init__(self, rig: RigFile, database: Database) -> None:
        self.rig = _Direction(rig, rig.measured, database, RIG_STATUS)
        self.bench = _Direction(rig, rig.commanded, database, BENCH_STATUS)
        shared = self.rig.messages.keys() & self.bench.messages.keys()
        if shared:
            name = self.rig.messages[shared.pop()].name
            raise BenchError(f"the CAN message {name} cannot go both ways")
        self.signature = signature(rig, layout_text(database))
        self.sequence_bits = self.rig.counter_bits
        self.from_rig = Assembly(self.rig.messages, self.rig.counter_bits)
        self.from_bench = Assembly(self.bench.messages, self.bench.counter_bits)
        self.clock = Unwrapped(bits(self.rig.status, "Clock"))

    def pack_frame(self, frame: Frame) -> list[CanFrame]:
        """Return the CAN frames of the rig's measurements."""
        clock = (frame.rig_ns // 1000) % self.clock.modulus
        table = self.signature & self.rig.table_mask
        status = {"Clock": clock, "Safe": int(frame.rig_safe), "Table": table}
        return self.rig.encode(frame.values, frame.sequence, **status)

    def take_frame(self, number: int, data: bytes) -> Frame | None:
        """Take a CAN frame; return the measurements that it completes. Raises PacketError."""
        parts = self.from_rig.take(number, data)
        if parts is None:
            return None
        status = parts[self.rig.status.frame_id]
        self._check_table(status["Table"], self.rig)
        rig_ns = self.clock.follow(status["Clock"]) * 1000
        return Frame(status["Counter"], rig_ns, self.rig.values(parts), bool(status["Safe"]))

    def pack_demand(self, demand: Demand) -> list[CanFrame]:
        """Return the CAN frames of the bench's commands."""
        answers = demand.answers % (1 << bits(self.bench.status, "Answers"))
        table = self.signature & self.bench.table_mask
        status = {"Answers": answers, "Order": int(demand.order), "Table": table}
        return self.bench.encode(demand.values, demand.sequence, **status)

    def take_demand(self, number: int, data: bytes) -> Demand | None:
        """Take a CAN frame; return the commands that it completes. Raises PacketError."""
        parts = self.from_bench.take(number, data)
        if parts is None:
            return None
        status = parts[self.bench.status.frame_id]
        self._check_table(status["Table"], self.bench)
        order = order_of(status["Order"])
        return Demand(status["Counter"], status["Answers"], order, self.bench.values(parts))

    def _check_table(self, table: int, direction: _Direction) -> None:
        if table != self.signature & direction.table_mask:
            raise PacketError("the other end has another channel table or DBC file")
