"""CAN frames of one rig, as the DBC file lays them out, to packets and back.

A packet is several CAN frames: those with the channels, and a status frame (``RigStatus`` from the
rig, ``BenchStatus`` to it). All carry the signal ``Counter``, the packet's sequence number modulo
its size; a packet is complete when every frame with its number has come. ``RigStatus`` has further
``Clock`` (us of the rig's clock) and ``Safe``, ``BenchStatus`` has ``Answers`` and ``Order``, and
both ``Table``, the low bits of the channel table's and DBC file's signature. A channel without a
value is sent as the lowest number of a signed signal, the highest of an unsigned one, or NaN. The
frames of a packet may be on several buses. With a key a packet has one frame more (``can_trust``).
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from typing import NamedTuple

from rig_bridge.conversion import raw_of, si_of
from rig_bridge.rig_file import RigFile
from rig_bridge.transport.assembly import Assembly, Parts, Unwrapped
from rig_bridge.transport.can_fields import CanField, bits, check_whole
from rig_bridge.transport.can_layout import Bus, Key, Layout, Slot
from rig_bridge.transport.can_trust import NAMES, MeetFrame, TagFrame
from rig_bridge.transport.dbc import layout_text
from rig_bridge.transport.packets import Demand, Frame, PacketError, order_of
from rig_bridge.transport.signature import signature
from rig_bridge.trust.peer import BenchPeer, Budget, Peer, RigPeer
from steering_core.errors import BenchError

COUNTER = {"Counter": 3}
RIG_STATUS = ("RigStatus", COUNTER | {"Clock": 16, "Safe": 1, "Table": 8})
BENCH_STATUS = ("BenchStatus", COUNTER | {"Answers": 1, "Order": 2, "Table": 8})
"""Status frames, and their signals with the least bits that tell one packet from the next."""


class CanFrame(NamedTuple):
    """A frame on one of the buses. ``extended``: the identifier has 29 bits, not 11."""

    number: int
    data: bytes
    extended: bool = False
    fd: bool = False
    bus: int = 0


class _Direction:
    """The frames of one direction: messages by bus and identifier, and the channels in them.

    sender: whose tag goes along, where the link has a key.
    """

    def __init__(
        self,
        rig: RigFile,
        names: Sequence[str],
        layout: Layout,
        status: tuple[str, Mapping[str, int]],
        sender: str | None,
    ) -> None:
        self.fields = [CanField(name, rig.channels[name], layout) for name in names]
        self.status = layout.slot(status[0])
        check_whole(self.status.message, status[1])
        self.status_key = self.status.key
        self.tag = None if sender is None else TagFrame(sender, layout)
        self.slots: dict[Key, Slot] = {}
        last = [self.status] if self.tag is None else [self.status, self.tag.slot]
        for slot in (*(field.slot for field in self.fields), *last):
            if self.slots.setdefault(slot.key, slot) is not slot:
                name = self.slots[slot.key].message.name
                raise BenchError(f"{name} and {slot.message.name} have the same CAN identifier")
            check_whole(slot.message, COUNTER)
        for slot in last:
            self.slots[slot.key] = self.slots.pop(slot.key)
        sizes = {bits(slot.message, "Counter") for slot in self.slots.values()}
        if len(sizes) > 1:
            raise BenchError(f"the Counter of {status[0]}'s frames must be equally wide everywhere")
        self.counter_bits = sizes.pop()
        self.table_mask = (1 << bits(self.status.message, "Table")) - 1
        self.plain = {
            key: s for key, s in self.slots.items() if self.tag is None or s is not last[1]
        }
        self.empty = {
            key: {signal.name: 0 for signal in slot.message.signals}
            for key, slot in self.plain.items()
        }
        self._check_twice(status[1])

    @property
    def quick(self) -> dict[Key, Callable[[bytes], Mapping[str, int]]]:
        """How frames are read that need no cantools."""
        return {} if self.tag is None else {self.tag.key: self.tag.numbers.decode}

    def encode(
        self, values: Sequence[float], counter: int, peer: Peer | None, **status: int
    ) -> list[CanFrame]:
        """Return the CAN frames, the status last, behind it the tag where there is a key."""
        signals: dict[Key, dict[str, float]] = {key: {**rest} for key, rest in self.empty.items()}
        for field, value in zip(self.fields, values, strict=True):
            signals[field.key][field.signal] = field.encoded(raw_of(field.row, value))
        signals[self.status_key] |= status
        frames: list[CanFrame] = []
        for key, slot in self.plain.items():
            whole = signals[key]
            whole["Counter"] = counter % (1 << self.counter_bits)
            bus, number, extended = key
            data = slot.message.encode(whole, scaling=False, strict=False)
            frames.append(CanFrame(number, data.ljust(slot.length, b"\0"), extended, slot.fd, bus))
        if self.tag is not None and peer is not None:
            seal = peer.seal(b"".join([frame.data for frame in frames]))
            bus, number, extended = self.tag.key
            data = self.tag.encode(seal, counter)
            frames.append(CanFrame(number, data, extended, self.tag.slot.fd, bus))
        return frames

    def values(self, parts: Parts) -> tuple[float, ...]:
        """Return the SI values of a complete packet."""
        numbers = (f.decoded(parts[f.key].signals[f.signal]) for f in self.fields)
        return tuple(si_of(f.row, raw) for f, raw in zip(self.fields, numbers, strict=True))

    def admit(self, parts: Parts, peer: Peer | None) -> Mapping[str, int]:
        """Return the status of a complete packet; raises PacketError where its tag does not fit."""
        if self.tag is not None and peer is not None:
            data = [parts[key].data for key in self.plain]
            peer.admit(b"".join(data), self.tag.seal(parts[self.tag.key].signals))
        return parts[self.status_key].signals

    def _check_twice(self, status: Iterable[str]) -> None:
        taken = {f"{slot.message.name}.Counter" for slot in self.slots.values()}
        taken |= {f"{self.status.message.name}.{name}" for name in status}
        if self.tag is not None:
            taken |= {f"{self.tag.slot.message.name}.{name}" for name in ("Fresh", "Tag")}
        for field in self.fields:
            if field.where in taken:
                raise BenchError(f"channel table: {field.where} stands for two things")
            taken.add(field.where)


class CanCodec:
    """Packets of one rig as CAN frames. ``take_*`` give a packet once its last frame has come.

    key: of the rig, None for a link without one. rig_end: which end this is, for the key.
    """

    def __init__(
        self, rig: RigFile, buses: Sequence[Bus], key: bytes | None = None, rig_end: bool = False
    ) -> None:
        layout = Layout(buses)
        senders = (None, None) if key is None else ("rig", "bench")
        self.rig = _Direction(rig, rig.measured, layout, RIG_STATUS, senders[0])
        self.bench = _Direction(rig, rig.commanded, layout, BENCH_STATUS, senders[1])
        self.peer: Peer | None = None
        self.meet_number: int | None = None
        if key is not None:
            self._meets(key, rig_end, layout)
        shared = self.rig.slots.keys() & self.bench.slots.keys()
        if shared:
            name = self.rig.slots[shared.pop()].message.name
            raise BenchError(f"the CAN message {name} cannot go both ways")
        self._check_listed(buses)
        self.signature = signature(rig, _layouts(buses))
        self.sequence_bits = self.rig.counter_bits
        own: dict[Key, Slot] = {} if self.peer is None else {self.our_meet.key: self.our_meet.slot}
        up, down = self.rig, self.bench
        self.from_rig = Assembly(up.slots, down.slots | own, up.counter_bits, up.quick)
        self.from_bench = Assembly(down.slots, up.slots | own, down.counter_bits, down.quick)
        self.clock = Unwrapped(bits(self.rig.status.message, "Clock"))

    def _meets(self, key: bytes, rig_end: bool, layout: Layout) -> None:
        ours, theirs = ("rig", "bench") if rig_end else ("bench", "rig")
        self.our_meet, self.their_meet = MeetFrame(ours, layout), MeetFrame(theirs, layout)
        taken = self.rig.slots | self.bench.slots
        for meet in (self.our_meet, self.their_meet):
            if taken.setdefault(meet.key, meet.slot) is not meet.slot:
                raise BenchError(
                    f"{meet.slot.message.name} has the CAN identifier of another frame"
                )
        if self.our_meet.nonce_bytes != self.their_meet.nonce_bytes:
            raise BenchError("the DBC file does not fit: the Nonces of both ends differ in width")
        self.meet_number = self.their_meet.key[1]
        kind = RigPeer if rig_end else BenchPeer
        self.peer = kind(key, self.our_meet.nonce_bytes, Budget())

    def greeting(self, nonce: bytes) -> CanFrame:
        """Return the frame of this end's part in a meeting."""
        bus, number, extended = self.our_meet.key
        fd = self.our_meet.slot.fd
        return CanFrame(number, self.our_meet.encode(nonce), extended, fd, bus)

    def take_greeting(
        self, number: int, data: bytes, extended: bool = False, fd: bool = False, bus: int = 0
    ) -> bytes | None:
        """Return the random number of the other end; None for any other frame.

        Raises PacketError.
        """
        if number != self.meet_number or (bus, number, extended) != self.their_meet.key:
            return None
        return self.their_meet.decode(data, fd)

    @property
    def slots(self) -> list[Slot]:
        """All messages of both directions, but those of a meeting: they come in place of others."""
        return [*self.rig.slots.values(), *self.bench.slots.values()]

    def name_of(self, key: Key) -> str | None:
        """Return the name of the rig's message with this bus and identifier."""
        slot = self.rig.slots.get(key) or self.bench.slots.get(key)
        return None if slot is None else slot.message.name

    def pack_frame(self, frame: Frame) -> list[CanFrame]:
        """Return the CAN frames of the rig's measurements."""
        clock = (frame.rig_ns // 1000) % self.clock.modulus
        table = self.signature & self.rig.table_mask
        status = {"Clock": clock, "Safe": int(frame.rig_safe), "Table": table}
        return self.rig.encode(frame.values, frame.sequence, self.peer, **status)

    def take_frame(
        self, number: int, data: bytes, extended: bool = False, fd: bool = False, bus: int = 0
    ) -> Frame | None:
        """Take a CAN frame; return the measurements that it completes. Raises PacketError."""
        parts = self.from_rig.take((bus, number, extended), data, fd)
        if parts is None:
            return None
        status = self.rig.admit(parts, self.peer)
        self._check_table(status["Table"], self.rig)
        rig_ns = self.clock.follow(status["Clock"]) * 1000
        return Frame(status["Counter"], rig_ns, self.rig.values(parts), bool(status["Safe"]))

    def pack_demand(self, demand: Demand) -> list[CanFrame]:
        """Return the CAN frames of the bench's commands."""
        answers = demand.answers % (1 << bits(self.bench.status.message, "Answers"))
        table = self.signature & self.bench.table_mask
        status = {"Answers": answers, "Order": int(demand.order), "Table": table}
        return self.bench.encode(demand.values, demand.sequence, self.peer, **status)

    def take_demand(
        self, number: int, data: bytes, extended: bool = False, fd: bool = False, bus: int = 0
    ) -> Demand | None:
        """Take a CAN frame; return the commands that it completes. Raises PacketError."""
        parts = self.from_bench.take((bus, number, extended), data, fd)
        if parts is None:
            return None
        status = self.bench.admit(parts, self.peer)
        self._check_table(status["Table"], self.bench)
        order = order_of(status["Order"])
        return Demand(status["Counter"], status["Answers"], order, self.bench.values(parts))

    def _check_table(self, table: int, direction: _Direction) -> None:
        if table != self.signature & direction.table_mask:
            raise PacketError("the other end has another channel table or DBC file")

    def _check_listed(self, buses: Sequence[Bus]) -> None:
        used = {(slot.bus, slot.message.name) for slot in self.slots}
        for index, bus in enumerate(buses):
            for name in bus.messages or ():
                if (index, name) not in used and name not in NAMES:
                    raise BenchError(
                        f"links.can: message '{name}' of {bus.name} is not one of the rig's: no "
                        "channel is in it"
                    )
            if all(slot.bus != index for slot in self.slots):
                raise BenchError(f"links.can: no message of the rig is on {bus.name}")


def _layouts(buses: Sequence[Bus]) -> str:
    """Return the layout of all files, each once; which bus is which is not part of it."""
    databases = {id(bus.database): bus.database for bus in buses}
    return "\n".join(layout_text(database) for database in databases.values())
