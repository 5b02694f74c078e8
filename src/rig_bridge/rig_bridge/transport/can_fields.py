"""A channel's signal in the DBC file, checked: it exists and holds the channel's range."""

from __future__ import annotations

from collections.abc import Iterable

from cantools.database.can import Database, Message, Signal

from rig_bridge.channels import Channel
from rig_bridge.conversion import raw_of
from steering_core.errors import BenchError
from steering_core.naming import unknown


def find_message(database: Database, name: str) -> Message:
    """Return a message of the DBC file; BenchError names the nearest one."""
    known = {message.name: message for message in database.messages}
    if name not in known:
        raise BenchError(f"the DBC file does not fit: {unknown('message', name, known)}")
    return known[name]


def check_signals(message: Message, names: Iterable[str]) -> None:
    """Raise BenchError for a signal that ``message`` lacks."""
    known = [signal.name for signal in message.signals]
    for name in names:
        if name not in known:
            what = unknown(f"signal of {message.name}", name, known)
            raise BenchError(f"the DBC file does not fit: {what}")


def bits(message: Message, name: str) -> int:
    """Return the width of a signal."""
    return int(message.get_signal_by_name(name).length)


class CanField:
    """One channel on the bus; raw numbers are physical values of the DBC file."""

    def __init__(self, name: str, row: Channel, database: Database) -> None:
        if row.can is None:
            raise BenchError(f"channel '{name}' has no place on CAN (can: {{message, signal}})")
        self.row = row
        self.message = find_message(database, row.can.message)
        check_signals(self.message, (row.can.signal,))
        self.signal = row.can.signal
        signal: Signal = self.message.get_signal_by_name(self.signal)
        if signal.is_float:
            raise BenchError(f"{self.message.name}.{self.signal}: floats are not supported")
        self.scale, self.offset = float(signal.scale), float(signal.offset)
        top = 1 << (signal.length - (1 if signal.is_signed else 0))
        self.lowest, self.highest = (-top + 1, top - 1) if signal.is_signed else (0, top - 2)
        self.no_value = -top if signal.is_signed else top - 1
        for value in row.range:
            if not self.lowest <= self._count(raw_of(row, value)) <= self.highest:
                where = f"{self.message.name}.{self.signal}"
                raise BenchError(f"channel '{name}': {where} cannot hold {value:g} {row.unit}")

    def encoded(self, raw: float) -> int:
        """Return the number in the frame, limited; NaN is the number that says "no value"."""
        if raw != raw:
            return self.no_value
        return int(min(max(self._count(raw), self.lowest), self.highest))

    def decoded(self, count: int) -> float:
        """Return the raw number of a frame's number; NaN where it says "no value"."""
        return float("nan") if count == self.no_value else self.scale * count + self.offset

    def _count(self, raw: float) -> float:
        count = (raw - self.offset) / self.scale
        return round(count) if abs(count) < 2.0**63 else count
