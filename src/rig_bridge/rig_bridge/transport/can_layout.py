"""The messages of a rig on its CAN buses: each on one bus, and one that the bridge can handle."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import NamedTuple

import cantools
from can.util import CAN_FD_DLC
from cantools.database.can import Database, Message

from steering_core.errors import BenchError
from steering_core.naming import unknown

CLASSIC_BYTES, FD_BYTES = 8, 64
Key = tuple[int, int, bool]
"""Bus, identifier, and whether it has 29 bits."""


@dataclass(frozen=True)
class Bus:
    """A bus: its name, the file that describes it, and which messages are on it (None: the rest).

    ``fd``: it carries CAN FD. ``switched``: with a rate of its own for the data.
    """

    name: str
    database: Database
    fd: bool = False
    messages: Sequence[str] | None = None
    switched: bool = False


class Slot(NamedTuple):
    """A message on its bus; ``length``: bytes of data of its frames."""

    bus: int
    bus_name: str
    message: Message
    fd: bool
    length: int

    @property
    def key(self) -> Key:
        """What tells its frames from all others."""
        return self.bus, self.message.frame_id, bool(self.message.is_extended_frame)

    @property
    def bits(self) -> int:
        """Width of the identifier."""
        return 29 if self.message.is_extended_frame else 11


@dataclass
class Layout:
    """Finds messages by name. BenchError says why one cannot be used; others may have any fault."""

    buses: Sequence[Bus]
    found: dict[str, Slot] = field(default_factory=dict)

    def slot(self, name: str) -> Slot:
        """Return the message called ``name``."""
        if name not in self.found:
            index = self._bus_of(name)
            self.found[name] = _slot(index, self.buses[index], name)
        return self.found[name]

    def _bus_of(self, name: str) -> int:
        listed = [i for i, bus in enumerate(self.buses) if name in (bus.messages or ())]
        rest = [i for i, bus in enumerate(self.buses) if bus.messages is None]
        if len(rest) > 1:
            names = " and ".join(self.buses[i].name for i in rest[:2])
            raise BenchError(
                f"links.can: which messages are on {names}? List them (messages: [...])"
            )
        if len(listed) > 1:
            names = " and ".join(self.buses[i].name for i in listed[:2])
            raise BenchError(f"links.can: message '{name}' is on {names}: it must be on one bus")
        if not (listed or rest):
            raise BenchError(f"links.can: message '{name}' is on no bus: add it to messages: [...]")
        return (listed or rest)[0]


def _slot(index: int, bus: Bus, name: str) -> Slot:
    message = _message(bus, name)
    _check_readable(message)
    fd = _is_fd(bus, message)
    length = next(size for size in CAN_FD_DLC if size >= message.length)
    return Slot(index, bus.name, message, fd, length)


def _message(bus: Bus, name: str) -> Message:
    found = [message for message in bus.database.messages if message.name == name]
    faults = getattr(bus.database, "faults", {})
    if name in faults:
        raise BenchError(f"the DBC file does not fit: message '{name}': {faults[name]}")
    if not found:
        known = [message.name for message in bus.database.messages]
        raise BenchError(f"the DBC file does not fit: {unknown('message', name, known)}")
    if len(found) > 1:
        raise BenchError(f"the DBC file does not fit: {len(found)} messages are called '{name}'")
    return found[0]


def _check_readable(message: Message) -> None:
    wrong = None
    paged = next((s.name for s in message.signals if s.is_multiplexer or s.multiplexer_ids), None)
    if paged is not None:
        wrong = f"it is multiplexed ('{paged}'), and a frame must hold all its signals at once"
    if message.is_container:
        wrong = "it is a container of other messages"
    if message.length > FD_BYTES:
        wrong = f"{message.length} bytes are longer than any frame (CAN FD: {FD_BYTES})"
    try:
        message.refresh(strict=True)
    except cantools.database.errors.Error as error:
        wrong = wrong or str(error)
    if wrong is not None:
        raise BenchError(f"the DBC file does not fit: message '{message.name}': {wrong}")


def _is_fd(bus: Bus, message: Message) -> bool:
    """A message is CAN FD where the file says so or it is long, or the file says it of none."""
    long = message.length > CLASSIC_BYTES
    if not bus.fd:
        if long or message.is_fd:
            why = f"has {message.length} bytes" if long else "is a CAN FD frame (VFrameFormat)"
            raise BenchError(
                f"the DBC file does not fit: message '{message.name}' {why}, but the bus "
                f"{bus.name} is classic CAN (at most {CLASSIC_BYTES} bytes): set fd: true if it is "
                "CAN FD"
            )
        return False
    return long or bool(message.is_fd) or not _tells_format(bus.database)


def _tells_format(database: Database) -> bool:
    return any(
        message.is_fd or (message.dbc and "VFrameFormat" in message.dbc.attribute_definitions)
        for message in database.messages
    )
