"""A channel's signal in the DBC file, checked: it exists and holds the channel's range."""

from __future__ import annotations

import re
from collections.abc import Iterable, Mapping
from math import isfinite

from cantools.database.can import Message, Signal

from rig_bridge.channels import Channel
from rig_bridge.conversion import raw_of
from rig_bridge.transport.can_layout import Layout, Slot
from steering_core.errors import BenchError
from steering_core.naming import unknown

LARGEST = {16: 65504.0, 32: 3.4028234663852886e38, 64: 1.7976931348623157e308}
"""Largest finite number of a float of so many bits (IEEE 754)."""

NO_VALUE = re.compile(
    r"(?i)(?:^|[\W_])(sna|n/?a|nan)(?:$|[\W_])|invalid|fault|error|fehler|unknown|unavailable"
    r"|no[\W_]*data|(?:not|nicht)[\W_]*(?:avail|valid|init|defin|vorhanden|verf)|ung(?:ue|ü)ltig"
)
"""Names in a value table that say that there is no value."""


def check_signals(message: Message, names: Iterable[str]) -> None:
    """Raise BenchError for a signal that ``message`` lacks."""
    known = [signal.name for signal in message.signals]
    for name in names:
        if name not in known:
            what = unknown(f"signal of {message.name}", name, known)
            raise BenchError(f"the DBC file does not fit: {what}")


def check_whole(message: Message, least_bits: Mapping[str, int]) -> None:
    """Raise BenchError unless these signals are whole numbers without sign, and wide enough."""
    check_signals(message, least_bits)
    for name, least in least_bits.items():
        signal = message.get_signal_by_name(name)
        where = f"the DBC file does not fit: {message.name}.{name}"
        if signal.is_float or signal.is_signed:
            raise BenchError(f"{where} must be a whole number without sign")
        if signal.length < least:
            raise BenchError(f"{where} must have at least {least} bits, it has {signal.length}")


def bits(message: Message, name: str) -> int:
    """Return the width of a signal."""
    return int(message.get_signal_by_name(name).length)


class CanField:
    """One channel on the bus; raw numbers are physical values of the DBC file.

    A number that the value table names, and that lies beyond what the channel or the signal may
    be, says "no value", as the lowest of a signed signal and the highest of an unsigned one do.
    """

    def __init__(self, name: str, row: Channel, layout: Layout) -> None:
        if row.can is None:
            raise BenchError(f"channel '{name}' has no place on CAN (can: {{message, signal}})")
        self.row = row
        self.slot: Slot = layout.slot(row.can.message)
        self.key = self.slot.key
        check_signals(self.slot.message, (row.can.signal,))
        self.signal = row.can.signal
        self.where = f"{self.slot.message.name}.{self.signal}"
        signal: Signal = self.slot.message.get_signal_by_name(self.signal)
        self.scale, self.offset = float(signal.scale), float(signal.offset)
        if not isfinite(self.scale) or not isfinite(self.offset) or self.scale == 0.0:
            raise BenchError(f"channel '{name}': {self.where} has a scale of {self.scale:g}")
        self.whole = not signal.is_float
        self.lowest, self.highest, self.no_value = _limits(signal)
        ends = [self._count(raw_of(row, value)) for value in row.range]
        for value, count in zip(row.range, ends, strict=True):
            if not self.lowest <= count <= self.highest:
                raise BenchError(f"channel '{name}': {self.where} cannot hold {value:g} {row.unit}")
        self.named = self._named(name, signal, min(ends), max(ends))

    def encoded(self, raw: float) -> float:
        """Return the number in the frame, limited; NaN is the number that says "no value"."""
        if raw != raw:
            return self.no_value
        return min(max(self._count(raw), self.lowest), self.highest)

    def decoded(self, count: float) -> float:
        """Return the raw number of a frame's number; NaN where it says "no value"."""
        if count == self.no_value or count in self.named:
            return float("nan")
        return self.scale * count + self.offset

    def _count(self, raw: float) -> float:
        count = (raw - self.offset) / self.scale
        return round(count) if self.whole and abs(count) < 2.0**63 else count

    def _named(self, name: str, signal: Signal, least: float, most: float) -> frozenset[int]:
        """Return the numbers of the value table that are no values of the channel."""
        found = set()
        for count, text in (signal.choices or {}).items():
            within = least <= count <= most
            if within and NO_VALUE.search(str(text)):
                raise BenchError(
                    f"channel '{name}': its range holds {self.scale * count + self.offset:g}, "
                    f"which is '{text}' in the value table of {self.where}: narrow the range"
                )
            if not within or self._is_reserved(signal, count):
                found.add(count)
        return frozenset(found)

    def _is_reserved(self, signal: Signal, count: int) -> bool:
        low, high = signal.minimum, signal.maximum
        if low is None or high is None or not low < high:
            return False
        return not low <= self.scale * count + self.offset <= high


def _limits(signal: Signal) -> tuple[float, float, float]:
    """Return the lowest and highest number of a signal, and the one that is no value."""
    if signal.is_float:
        largest = LARGEST[signal.length]
        return -largest, largest, float("nan")
    top = 1 << (signal.length - (1 if signal.is_signed else 0))
    return (-top + 1, top - 1, -top) if signal.is_signed else (0, top - 2, top - 1)
