"""The arbiter of overlays written a second time, from docs/overlay_node.md and the data sheet."""

from __future__ import annotations

import math
import statistics
from dataclasses import dataclass, field

import numpy as np
from overlay_rules import Rules

from steering_core.parameters import ParameterSet

DT = 1e-3
MOST_RANK = 1e6
PLACES = 64
MOST_FELT = 100.0
FASTEST_CAR = 200.0
CREEPING = 1e-3
"""m/s at which a car without centring of its own is as at rest."""


@dataclass
class Source:
    """What is known of one source; ``longest``: ticks after which it is silent."""

    longest: float
    torque: float = 0.0
    rank: float = 0.0
    heard: int | None = None
    taken: int | None = None
    silent: bool = False
    refused: bool = False
    came: list[int] = field(default_factory=list)


@dataclass
class SecondArbiter:
    """Members with their periods and delays [ticks] first, then guests by name."""

    parameters: ParameterSet
    periods: tuple[int, ...] = ()
    delays: tuple[int, ...] = ()
    guests: dict[str, int] = field(default_factory=dict)
    mail: dict[int, tuple[int, float, float]] = field(default_factory=dict)
    rules: dict[float, Rules] = field(default_factory=dict)

    def __post_init__(self) -> None:
        self.p = self.parameters.group("overlay")
        self.wheel = self.parameters.group("mechanics")
        self.sources = [Source(period * self.p["stale_periods"]) for period in self.periods]
        self.applied = self.origin = self.felt = self.turning = 0.0
        self.authority, self.share = 1.0, 1.0
        self.turn = -1
        self.counts = np.zeros(3)  # refusals, silences, overrides

    def hear_guest(self, name: str, tick: int, torque: float, priority: float) -> None:
        """A guest's message; of those before one tick the last counts."""
        if name not in self.guests and not self._seat(name, torque, priority):
            return
        row = self.guests[name]
        self._time(self.sources[row], tick)
        self.mail[row] = (tick, torque, priority)

    def _seat(self, name: str, torque: float, priority: float) -> bool:
        """64 places; a silent guest's goes first, then the least one's to a greater priority."""
        if len(self.guests) < PLACES:
            self.guests[name] = len(self.sources)
            self.sources.append(Source(0.0))
            return True
        gone = [
            (self.mail[row][0], row, old)
            for old, row in self.guests.items()
            if self.sources[row].silent or (self.sources[row].refused and not self._heard(row))
        ]
        if gone:
            _, row, old = min(gone)
        elif self._is_wish(torque, priority):
            others = [
                (-math.inf if math.isnan(rank := self.mail[row][2]) else rank, row, old)
                for old, row in self.guests.items()
                if row != self.turn
            ]
            least, row, old = min(others)
            if least >= priority:
                return False
        else:
            return False
        del self.guests[old]
        self.guests[name] = row
        self.sources[row] = Source(0.0)
        self.mail.pop(row)
        return True

    def _heard(self, row: int) -> bool:
        return self.sources[row].heard is not None

    def _is_wish(self, torque: float, rank: float) -> bool:
        wrong = math.isnan(torque) or math.isnan(rank)
        return not (wrong or abs(torque) > self.p["out_of_range"] or abs(rank) > MOST_RANK)

    def _time(self, source: Source, tick: int) -> None:
        """Three of the guest's periods: the median of its last five waits, in the bounds."""
        if tick not in source.came:
            source.came.append(tick)
        waits = np.diff(source.came)[-5:].tolist() or [0.0]
        bounds = self.p["guest_period"] / DT, self.p["longest_guest_period"] / DT
        period = float(np.clip(statistics.median_low(waits), *bounds))
        source.longest = self.p["stale_periods"] * period

    def step(
        self, tick: int, angle: float, wheel: float, bar: float, speed: float, *asked: float
    ) -> np.ndarray:
        """Return the 19 numbers of TorqueOverlayApplied."""
        self._collect(tick, asked)
        for number, source in enumerate(self.sources):
            self._take(number, source)
            silent = source.heard is not None and tick - source.heard > source.longest
            self.counts[1] += silent and not source.silent
            source.silent = silent
        turn, wish = self._turn()
        if turn != self.turn:
            self.turn, self.share, self.origin = turn, 0.0, self.applied
        self.share = min(1.0, self.share + DT / self.p["fade_time"])
        wanted = self.origin + (wish - self.origin) * self.share
        hand = self._hand(wheel, bar)
        self._yield_to(hand, wanted)
        return self._apply(wish, wanted * self.authority, hand, speed)

    def _collect(self, tick: int, asked: tuple[float, ...]) -> None:
        delays = self.delays or (0,) * len(self.periods)
        for i, (period, delay) in enumerate(zip(self.periods, delays, strict=True)):
            if tick >= delay:
                sent = (tick - delay) - (tick - delay) % period
                self.mail[i] = (sent, asked[2 * i], asked[2 * i + 1])

    def _take(self, number: int, source: Source) -> None:
        if number not in self.mail or self.mail[number][0] == source.taken:
            return
        sent, torque, rank = self.mail[number]
        source.taken = sent
        source.refused = not self._is_wish(torque, rank)
        if source.refused:
            self.counts[0] += 1
        else:
            source.torque, source.rank, source.heard = torque, rank, sent

    def _turn(self) -> tuple[int, float]:
        willing = [
            (-source.rank, number)
            for number, source in enumerate(self.sources)
            if source.heard is not None and not source.silent and source.rank >= 0.0
        ]
        if not willing:
            return -1, 0.0
        number = min(willing)[1]
        return number, self.sources[number].torque

    def _hand(self, wheel: float, bar: float) -> float:
        """Torque of the hands: what the wheel's balance lacks, every term low-passed."""
        wheel = float(np.clip(wheel, -MOST_FELT, MOST_FELT)) if math.isfinite(wheel) else 0.0
        bar = float(np.clip(bar, -MOST_FELT, MOST_FELT)) if math.isfinite(bar) else 0.0
        weight = 1.0 - math.exp(-DT / self.p["hand_torque_lowpass"])
        self.felt += weight * (bar + self.wheel["steering_wheel_damping"] * wheel - self.felt)
        before, self.turning = self.turning, self.turning + weight * (wheel - self.turning)
        return self.felt + self.wheel["steering_wheel_inertia"] * (self.turning - before) / DT

    def _yield_to(self, hand: float, wanted: float) -> None:
        against = -math.copysign(1.0, wanted) * hand if wanted else 0.0
        start, full = self.p["override_start"], self.p["override_full"]
        left = float(np.interp(against, [start, full], [1.0, 0.0]))
        back = self.authority + DT / self.p["override_recovery"]
        left = min(left, back)
        self.counts[2] += left < 1.0 and self.authority == 1.0
        self.authority = left

    def _apply(self, wish: float, wanted: float, hand: float, speed: float) -> np.ndarray:
        fast = min(abs(speed), FASTEST_CAR) if math.isfinite(speed) else FASTEST_CAR
        fast = max(fast, CREEPING)
        if fast not in self.rules:
            self.rules[fast] = _rules(self.parameters, fast)
        rules = self.rules[fast]
        level = float(np.clip(wanted, -rules.level, rules.level))
        by_level = [abs(wanted) > bound for bound in rules.levels]
        by_step = [abs(level - self.applied) > bound for bound in rules.steps]
        low, high = self.applied - rules.step, self.applied + rules.step
        self.applied = float(np.clip(level, low, high))
        return np.array(
            [
                *(wish, self.applied, self.applied * rules.per_torque, self.applied * rules.gain),
                *(hand, self.authority, self.turn + 1, *by_level, *by_step),
                *(self.share < 1.0, self.authority < 1.0),
                any(s.silent for s in self.sources),
                any(s.refused for s in self.sources),
                *self.counts,
            ]
        )


def _rules(parameters: ParameterSet, speed: float) -> Rules:
    """Beyond its critical speed a car has no steady state: as if nothing centred the rack."""
    p = parameters.group("vehicle")
    a, b = p["front_axle_distance"], p["rear_axle_distance"]
    c_f, c_r = p["front_cornering_stiffness"], p["rear_cornering_stiffness"]
    understeer = p["mass"] * (b * c_r - a * c_f) / (c_f * c_r * (a + b) ** 2)
    if 1.0 + understeer * speed**2 <= 0.0:
        parameters = parameters.with_values({"overlay.centring_stiffness": 0.0})
    return Rules(parameters, speed)
