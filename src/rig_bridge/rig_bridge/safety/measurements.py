"""All watchdogs on what the rig sends, taken together."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from typing import Protocol

from rig_bridge.rig_file import LOAD_REFERENCE, RigFile
from rig_bridge.safety.agreement import RateWatch, RelationWatch
from rig_bridge.safety.channel_watch import ChannelWatch
from rig_bridge.safety.clock_watch import ClockWatch
from rig_bridge.safety.faults import Fault, Kind
from rig_bridge.safety.frame_watch import Frame, FrameWatch


class Resettable(Protocol):
    """A watchdog that can begin again."""

    def reset(self) -> None:
        """Take the next sample as the first."""


class Measurements:
    """Takes a tick's frames; ``values`` are what may be used, SI, by name.

    ``periods``: a row of values for each period of the rig since the last tick; one whose frame
    was lost holds the values before it (as many of them as are a fault at most).
    """

    def __init__(self, rig: RigFile, sequence_bits: int) -> None:
        self.frames = FrameWatch(rig.watching, sequence_bits)
        self.clock = ClockWatch(rig.watching)
        watching = rig.watching
        self.channels = [ChannelWatch(n, rig.channels[n], watching) for n in rig.measured]
        self.relations = [RelationWatch(name, entry) for name, entry in rig.relations.items()]
        self.rates = [RateWatch(name, pair) for name, pair in rig.rates.items()]
        self.fresh = False
        self.periods: list[tuple[float, ...]] = []
        self.most_held = rig.watching.stale_ticks

    def reset(self) -> None:
        """Take the next frame as the first; the usable values stay."""
        self.frames.reset()
        self.clock.reset()
        watches: list[Resettable] = [*self.channels, *self.relations, *self.rates]
        for watch in watches:
            watch.reset()

    @property
    def values(self) -> dict[str, float]:
        """The last good value of each channel."""
        return {watch.name: watch.good for watch in self.channels}

    def tick(self, frames: Iterable[Frame], now_ns: int, sent: Mapping[str, float]) -> Fault | None:
        """Take the frames that came since the last tick; return the first thing that is wrong."""
        new = self.frames.tick(frames)
        self.fresh = bool(new)
        self.periods = []
        found = [self.frames.fault()]
        for index, (frame, steps) in enumerate(new):
            newest = index == len(new) - 1
            self.periods += [self._row()] * min(steps - 1, self.most_held)
            found.append(self.clock.see(frame.rig_ns, steps, now_ns if newest else None))
            found += self._see(frame, steps, sent)
            self.periods.append(self._row())
        return next((fault for fault in found if fault is not None), None)

    def _row(self) -> tuple[float, ...]:
        return tuple(watch.good for watch in self.channels)

    def _see(self, frame: Frame, steps: int, sent: Mapping[str, float]) -> list[Fault | None]:
        pairs = zip(self.channels, frame.values, strict=True)
        found = [watch.see(value, steps) for watch, value in pairs]
        signals = self.values | dict(sent)
        if LOAD_REFERENCE not in signals:
            signals[LOAD_REFERENCE] = load_reference(signals)
        found += [watch.see(signals, steps) for watch in self.relations]
        found += [watch.see(signals, steps) for watch in self.rates]
        if frame.rig_safe:
            found.append(Fault(Kind.RIG, None, "its own watchdog or a person stopped it"))
        return found


def load_reference(signals: Mapping[str, float]) -> float:
    """Return the load that the commands ask for at the measured rack position [N]."""
    stiffness = signals.get("load_stiffness", 0.0)
    stretch = signals["rack_position"] - signals.get("load_position", 0.0)
    return signals.get("load_force", 0.0) + stiffness * stretch
