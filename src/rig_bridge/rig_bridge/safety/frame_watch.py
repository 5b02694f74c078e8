"""Sorts frames by sequence number: new ones, repeated ones, late ones, and how many were lost."""

from __future__ import annotations

from collections.abc import Iterable
from typing import NamedTuple

from rig_bridge.safety.faults import Fault, Kind
from rig_bridge.watching import Watching


class Frame(NamedTuple):
    """A set of measurements. ``rig_ns``: on the rig's clock. ``values``: SI, NaN where missing."""

    sequence: int
    rig_ns: int
    values: tuple[float, ...]
    rig_safe: bool = False


class FrameWatch:
    """Passes each frame on once and in order. Sequence numbers count modulo ``2**bits``.

    A single stray frame is dropped and counted; as many as ``watching.bad_frames``, less what
    drains in the meantime, are a fault.
    """

    def __init__(self, watching: Watching, bits: int) -> None:
        self.modulus = 1 << bits
        self.watching = watching
        self.repeated = 0
        self.late = 0
        self.lost = 0
        self.reset()

    def reset(self) -> None:
        """Take the next frame as the first."""
        self.last: int | None = None
        self.level = 0.0
        self.silent = 0

    def tick(self, frames: Iterable[Frame]) -> list[tuple[Frame, int]]:
        """Return the new frames of a tick, each with the rig's periods since the one before."""
        self.level = max(self.level - self.watching.bad_frames_drain, 0.0)
        new = [(frame, steps) for frame in frames if (steps := self._steps(frame.sequence))]
        self.silent = 0 if new else self.silent + 1
        return new

    def fault(self) -> Fault | None:
        """Return what is wrong with the stream of frames at present."""
        if self.silent >= self.watching.stale_ticks:
            return Fault(Kind.STALE, None, f"for {self.silent} ticks")
        if self.level > self.watching.bad_frames - 1e-9:
            counts = f"{self.repeated} repeated, {self.late} late, {self.lost} lost so far"
            return Fault(Kind.FRAMES, None, counts)
        return None

    def _steps(self, sequence: int) -> int:
        """Return the periods since the last new frame; 0 for one that is not new."""
        if self.last is None:
            self.last = sequence
            return 1
        steps = (sequence - self.last) % self.modulus
        if steps == 0:
            self.repeated += 1
            self.level += 1.0
            return 0
        if steps >= self.modulus // 2:
            self.late += 1
            self.level += 1.0
            return 0
        self.last = sequence
        self.lost += steps - 1
        self.level += steps - 1.0
        return steps
