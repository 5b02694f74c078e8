"""Short runs of the arbiter that go through every branch of it."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

import numpy as np

QUICK = {
    "overlay.fade_time": 0.04,
    "overlay.override_recovery": 0.05,
    "overlay.hand_torque_lowpass": 0.004,
    "overlay.maximum_rate": 300.0,
    "overlay.maximum_lateral_jerk": 60.0,
    "overlay.override_start": 0.8,
    "overlay.override_full": 2.5,
    "mechanics.steering_wheel_damping": 0.3,
}
"""A quick arbiter, so that a story needs some hundred ticks."""
OVERSTEERING = {"vehicle.front_cornering_stiffness": 1.6e5, "vehicle.rear_cornering_stiffness": 8e4}


HARDLY_ANY_TRAIL = {"vehicle.pneumatic_trail": 1e-4, "vehicle.mechanical_trail": 0.0}
AT_ONCE = QUICK | {
    "overlay.fade_time": 0.001,
    "overlay.hand_torque_lowpass": 2e-4,
    "overlay.maximum_rate": 250.0,
    "overlay.maximum_torque": 2.0,
}
"""Without fade and filter: a wish can be exactly at a limit, a driver is there from the start."""


RHYTHM = {"overlay.guest_period": 0.002, "overlay.longest_guest_period": 0.015}
"""Bounds of a guest's period that stories go past on both sides."""


@dataclass(frozen=True)
class Story:
    """A run with wishes, hands and speeds drawn from ``seed``.

    ``hands``: up to which [N m] and [rad/s]; ``chance``: of a guest's message at a tick, which
    comes ``twice``, of one of ``ranks``; ``wild``: with faults; ``exact``: wishes [N m], one after
    the other, in place of drawn ones; ``against``: the hand's torque [N m] all the time.
    """

    name: str
    values: dict[str, float]
    periods: tuple[int, ...]
    delays: tuple[int, ...]
    seed: int
    speeds: tuple[float, ...] = (20.0,)
    ticks: int = 260
    hands: float = 6.0
    wild: bool = False
    guests: int = 0
    chance: float = 0.3
    twice: bool = False
    ranks: tuple[float, ...] = (-1.0, 0.0, 1.0, 1.0, 2.0)
    exact: tuple[float, ...] = ()
    against: float | None = None

    def lines(self) -> Iterator[tuple[float, float, float, list[float], list[tuple[Any, ...]]]]:
        """Yield one line a tick; the same ones each time."""
        random = np.random.default_rng(self.seed)
        wishes = [0.0, -1.0] * len(self.periods)
        wheel = bar = 0.0
        for tick in range(self.ticks):
            if tick % 12 == 0:
                for i in range(len(self.periods)):
                    wishes[2 * i : 2 * i + 2] = self._wish(random)
                if self.exact:
                    wishes[:2] = self.exact[tick // 12 % len(self.exact)], 1.0
            if self.against is not None:
                wheel, bar = 0.0, self.against
            elif tick % (3 if self.wild else 25) == 0:
                wheel = float(random.uniform(-self.hands, self.hands))
                bar = float(random.uniform(-self.hands, self.hands))
                if self.wild and random.random() < 0.6:
                    wheel, bar = random.choice([math.nan, math.inf, -500.0, 500.0, 3.0], 2)
            quiet = tick // 60 % 2
            messages = [
                (f"guest {g}", *self._wish(random))
                for g in range(self.guests)
                if random.random() < self.chance and not (quiet and g == 0)
            ]
            speed = self.speeds[tick * len(self.speeds) // self.ticks]
            yield wheel, bar, speed, list(wishes), messages * (2 if self.twice else 1)

    def _wish(self, random: np.random.Generator) -> list[float]:
        torque = float(random.choice([random.uniform(-4.0, 4.0), random.uniform(-28.0, 28.0)]))
        rank = float(random.choice(self.ranks))
        if self.wild and random.random() < 0.5:
            torque = float(random.choice([math.nan, math.inf, 30.0, -30.0, 30.1, -30.1, torque]))
        if self.wild and random.random() < 0.3:
            rank = float(random.choice([math.nan, 1e6, -1e6, 1.1e6, -1.1e6]))
        return [torque, rank]


STORIES = (
    Story("one source", QUICK, (1,), (), 1, hands=0.5),
    Story("a driver", QUICK, (1,), (), 2),
    Story("two sources", QUICK, (1, 3), (), 3, hands=1.5),
    Story("faults", QUICK, (1, 10), (), 4, wild=True, hands=0.8, ticks=500),
    Story("faults of a guest", QUICK, (), (), 14, wild=True, hands=0.8, guests=2),
    Story("delays", QUICK, (5, 3), (4, 20), 5, hands=0.2),
    Story("guests", QUICK, (2,), (3,), 6, guests=2, hands=0.2),
    Story("quick guests", QUICK | RHYTHM, (), (), 18, guests=2, hands=0.2, ticks=400),
    Story("slow guests", QUICK | RHYTHM, (1,), (), 19, guests=3, hands=0.2, ticks=600, chance=0.08),
    Story("rare guests", QUICK | RHYTHM, (), (), 20, guests=2, hands=0.2, ticks=600, chance=0.03),
    Story(
        "guests that say all twice",
        QUICK | RHYTHM,
        (),
        (),
        21,
        guests=2,
        hands=0.2,
        ticks=400,
        chance=0.08,
        twice=True,
    ),
    Story("a crowd", QUICK | RHYTHM, (1,), (), 22, guests=70, hands=0.2, ticks=60, chance=0.6),
    Story(
        "a crowd that comes and goes",
        QUICK | RHYTHM,
        (),
        (),
        23,
        guests=160,
        hands=0.2,
        ticks=150,
        chance=0.06,
    ),
    Story(
        "a crowd of faults", QUICK | RHYTHM, (), (), 24, guests=80, wild=True, ticks=60, chance=0.5
    ),
    Story(
        "a crowd of equals",
        QUICK | RHYTHM,
        (),
        (),
        25,
        guests=80,
        hands=0.2,
        ticks=60,
        chance=0.8,
        ranks=(*[1.0] * 300, 2.0),
    ),
    Story("pressure", QUICK | {"overlay.maximum_pressure": 3e5}, (1,), (), 7, hands=0.3),
    Story(
        "slow and fast",
        QUICK | {"overlay.centring_stiffness": 4e4, "overlay.maximum_lateral_acceleration": 0.6},
        (1,),
        (),
        8,
        speeds=(20.0, 2.0, -15.0, math.nan, 300.0, -300.0, math.inf, 9.0),
        hands=0.3,
    ),
    Story(
        "oversteer",
        QUICK | OVERSTEERING | {"overlay.centring_stiffness": 4e4},
        (1,),
        (),
        9,
        speeds=(10.0, 23.9, 35.0, 80.0),
        hands=0.3,
    ),
    Story("torque", QUICK | {"overlay.maximum_torque": 2.0}, (1,), (), 12, hands=0.3),
    Story("at its limits", AT_ONCE, (1,), (), 13, hands=0.0, exact=(0.0, 0.25, 0.0, 2.0)),
    Story("a driver from the start", AT_ONCE, (1,), (), 15, exact=(2.0,), against=-2.0, ticks=30),
    Story("at rest", QUICK, (1,), (), 16, speeds=(0.0,), hands=0.3, ticks=60),
    Story("hardly any trail", QUICK | HARDLY_ANY_TRAIL, (1,), (), 17, hands=0.3, ticks=60),
    Story("rate", QUICK | {"overlay.maximum_rate": 40.0}, (1,), (), 10, hands=0.3),
    Story("as on the data sheet", {}, (10,), (), 11, ticks=1500, hands=2.0),
)
