"""The rig's own watchdog: it does not rely on the bench to make it safe."""

from __future__ import annotations

from collections.abc import Sequence
from math import isfinite

from rig_bridge.channels import Channel
from rig_bridge.transport.packets import Demand, Order


class RigWatchdog:
    """Obeys fresh commands within range while the order is to run; ``latched`` is its safe state.

    Only the order to arm ends it, and what follows an order to hold (``held``). channels: the
    commanded ones, in the order of the values.
    """

    def __init__(self, channels: Sequence[Channel], stale_ticks: int, sequence_bits: int) -> None:
        self.ranges = [channel.range for channel in channels]
        self.slack = [channel.scale for channel in channels]
        self.stale_ticks = stale_ticks
        self.modulus = 1 << sequence_bits
        self.latched = False
        self.held = False
        self.silent = 0
        self.demand: Demand | None = None

    def tick(self, demands: Sequence[Demand]) -> tuple[float, ...] | None:
        """Take the commands that have come; return those to obey, None for the safe state."""
        self.silent += 1
        for demand in demands:
            if self._is_new(demand):
                self.demand, self.silent = demand, 0
                self._follow(demand.order)
        if self.demand is None or self.demand.order is not Order.RUN:
            return None
        if self.silent >= self.stale_ticks or not self._is_within_range(self.demand.values):
            self.latched = True
        return None if self.latched or self.held else self.demand.values

    def _follow(self, order: Order) -> None:
        if order is Order.ARM:
            self.latched = self.held = False
        self.held = self.held or order is Order.HOLD

    def _is_new(self, demand: Demand) -> bool:
        if self.demand is None or self.silent > self.stale_ticks:
            return True  # a bench that was started again counts from 0
        steps = (demand.sequence - self.demand.sequence) % self.modulus
        return 0 < steps < self.modulus // 2

    def _is_within_range(self, values: Sequence[float]) -> bool:
        rows = zip(values, self.ranges, self.slack, strict=True)
        return all(isfinite(v) and low - s <= v <= high + s for v, (low, high), s in rows)
