"""Commands on their way to the rig: numbers, fresh, within range and rate, or the safe ones."""

from __future__ import annotations

from collections.abc import Mapping
from math import isfinite

from rig_bridge.rig_file import RigFile
from rig_bridge.safety.faults import Fault, Kind
from rig_bridge.safety.limits import blended, limited
from rig_bridge.signals import PERIOD_S


class Commands:
    """``sent`` are the commands of this tick, SI, by name; at first the safe ones."""

    def __init__(self, rig: RigFile) -> None:
        self.channels = {name: rig.channels[name] for name in rig.commanded}
        self.safe = {name: channel.safe for name, channel in self.channels.items()}
        self.stale_ticks = rig.watching.command_stale_ticks
        self.sent = dict(self.safe)
        self.limited = 0

    def fault(self, asked: Mapping[str, float], age: int, source: str | None) -> Fault | None:
        """Return what is wrong with what is asked.

        age: ticks since it was new. source: what is late where it is not new.
        """
        for name in self.channels:
            if not isfinite(asked[name]):
                return Fault(Kind.COMMAND_NOT_FINITE, name, f"{asked[name]}")
        if age >= self.stale_ticks:
            return Fault(Kind.COMMAND_STALE, source, f"for {age} ticks")
        return None

    def make_safe(self) -> None:
        """Send the safe commands at once, whatever the rate."""
        self.sent = dict(self.safe)

    def follow(self, asked: Mapping[str, float], share: float) -> None:
        """Send ``share`` of what is asked (finite), within range and rate."""
        for name, channel in self.channels.items():
            wanted = blended(channel.safe, float(asked[name]), share)
            step = channel.rate * PERIOD_S
            self.sent[name] = limited(wanted, self.sent[name], channel.range, step)
            self.limited += self.sent[name] != wanted
