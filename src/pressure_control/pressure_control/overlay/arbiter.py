"""The arbiter of torque overlays: any number of sources in, one limited torque out.

Order of a tick: hear the sources, choose one, fade over to it, let the driver's hands take their
share, limit the level, limit the step. Whatever comes in, what goes out keeps every limit.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Any

import numpy as np

from pressure_control.overlay.guests import Rhythm
from pressure_control.overlay.hands import hand_torque, left_authority
from pressure_control.overlay.lateral import lateral_fields, lateral_gain
from pressure_control.overlay.limits import (
    limited_step,
    limited_torque,
    note_limits,
    overlay_bounds,
)
from pressure_control.overlay.places import MOST_GUESTS, place_to_give
from pressure_control.overlay.sources import (
    BAD,
    HEARD,
    SEEN,
    SILENT,
    TORQUE,
    believable,
    falls_silent,
    hear,
    message_tick,
    served,
)
from steering_core.compiled import kernel
from steering_core.parameters import ParameterError, ParameterSet, record
from steering_core.ticks import TICK_PERIOD, TICKS_PER_SECOND

APPLIED, AUTHORITY, FILTER, FILTER_SPEED, SERVED, FADED, ORIGIN, REFUSED, SILENCES, OVERRIDES = (
    range(10)
)
"""States: torque [N m], authority, the two of ``hand_torque``, number of the source served (0:
none), share of the fade done, torque [N m] where it began, and three counts."""

OUTPUTS = 19
"""Numbers of a TorqueOverlayApplied, in the order of the message."""


@kernel
def arbiter_step(
    par: np.ndarray,
    state: np.ndarray,
    kept: np.ndarray,
    requests: np.ndarray,
    longest: np.ndarray,
    bounds: np.ndarray,
    out: np.ndarray,
    tick: int,
    speed: float,
    wheel_speed: float,
    bar: float,
) -> None:
    """Advance one tick and write the fields of TorqueOverlayApplied to ``out``, shape (19,).

    kept (n, 6), requests (n, 3): one row a source, see ``sources``; longest (n,) [ticks]: age up
    to which it is fresh. speed [m/s]: of the car. wheel_speed [rad/s] of the steering wheel and
    bar [N m], the torsion bar's torque: measured at this tick.
    """
    p = par[0]
    refused, silent = 0.0, 0.0
    for i in range(requests.shape[0]):
        state[REFUSED] += hear(p, requests[i], kept[i])
        state[SILENCES] += falls_silent(tick, longest[i], kept[i])
        refused = max(refused, kept[i, BAD])
        silent = max(silent, kept[i, SILENT])

    source = served(kept)
    asked = kept[source, TORQUE] if source >= 0 else 0.0
    if source + 1 != state[SERVED]:
        state[SERVED], state[FADED], state[ORIGIN] = source + 1, 0.0, state[APPLIED]
    state[FADED] = min(state[FADED] + p.fade_step, 1.0)
    wanted = state[ORIGIN] * (1.0 - state[FADED]) + asked * state[FADED]

    hand = hand_torque(p, state[FILTER : FILTER_SPEED + 1], wheel_speed, bar)
    authority = left_authority(p, state[AUTHORITY], wanted, hand)
    if authority < 1.0 and state[AUTHORITY] == 1.0:
        state[OVERRIDES] += 1.0
    state[AUTHORITY] = authority

    gain = lateral_gain(p, speed)
    overlay_bounds(p, gain, bounds)
    limited = limited_torque(wanted * authority, bounds)
    note_limits(wanted * authority, limited, state[APPLIED], bounds, out[7:12])
    state[APPLIED] = limited_step(limited, state[APPLIED], bounds)

    out[0], out[1], out[2] = asked, state[APPLIED], state[APPLIED] * p.pressure_gain
    out[3], out[4], out[5] = state[APPLIED] * gain, hand, authority
    out[6] = state[SERVED]
    out[12] = 1.0 if state[FADED] < 1.0 else 0.0
    out[13] = 1.0 if authority < 1.0 else 0.0
    out[14], out[15] = silent, refused
    out[16], out[17] = state[REFUSED], state[SILENCES]
    out[18] = state[OVERRIDES]


class OverlayArbiter:
    """The arbiter with its parameters, sources and states.

    periods, delays [ticks]: of the members, the sources whose messages come in lock step, in the
    order in which ``step`` takes them. Guests, the others, are added by ``hear_guest`` as they
    come. Raises ParameterError for limits that cannot be kept.
    """

    def __init__(
        self,
        parameters: ParameterSet,
        periods: Sequence[int] = (),
        delays: Sequence[int] = (),
    ) -> None:
        self.par = overlay_record(parameters)
        self.periods = np.array(periods, np.int64)
        self.delays = np.array(delays if len(delays) else np.zeros(len(periods)), np.int64)
        self.state = np.zeros(10)
        self.state[[AUTHORITY, FADED]] = 1.0
        self.bounds = np.zeros(5)
        self.out = np.zeros(OUTPUTS)
        self.stale_periods = parameters["overlay.stale_periods"]
        self.longest = self.periods * self.stale_periods
        self.guest_periods = guest_periods(parameters)
        self.kept = _unheard(len(self.periods))
        self.requests = np.zeros((len(self.periods), 3))
        self.guests: dict[str, int] = {}
        self.rhythms: list[Rhythm] = []

    def step(self, tick: int, *inputs: float) -> np.ndarray:
        """Return ``out`` for one tick.

        inputs: steering wheel angle [rad] and speed [rad/s], torsion-bar torque [N m], speed of
        the car [m/s], then torque [N m] and priority of each member.
        """
        _, wheel_speed, bar, speed, *asked = inputs
        for i in range(len(self.periods)):
            self.requests[i, :2] = asked[2 * i : 2 * i + 2]
            self.requests[i, 2] = message_tick(tick, self.delays[i], self.periods[i])
        par, state, kept, requests, longest, bounds, out = self.arrays()
        arbiter_step(
            par, state, kept, requests, longest, bounds, out, tick, speed, wheel_speed, bar
        )
        return self.out

    def arrays(self) -> tuple[np.ndarray, ...]:
        """Return what ``arbiter_step`` takes before the tick."""
        return (
            self.par,
            self.state,
            self.kept,
            self.requests,
            self.longest,
            self.bounds,
            self.out,
        )

    def hear_guest(self, name: str, tick: int, torque: float, priority: float) -> None:
        """Take a message of a source outside the lock step that came in before ``tick``.

        There are ``MOST_GUESTS`` places. Where all are taken a new guest has that of one who has
        fallen silent, else that of the one of least priority, if its own is greater; else it is
        not heard.
        """
        if name not in self.guests and not self._seat(name, torque, priority):
            return
        row = self.guests[name]
        rhythm = self.rhythms[row - len(self.periods)]
        rhythm.hear(tick)
        self.longest[row] = self.stale_periods * rhythm.period
        # of two messages within one tick the later one counts
        self.requests[row] = torque, priority, tick

    def _seat(self, name: str, torque: float, priority: float) -> bool:
        """Give a guest a place; return whether there is one."""
        if len(self.guests) < MOST_GUESTS:
            self.guests[name] = len(self.requests)
            self.kept = np.vstack([self.kept, _unheard(1)])
            self.requests = np.vstack([self.requests, np.zeros((1, 3))])
            self.longest = np.append(self.longest, 0.0)
            self.rhythms.append(Rhythm(*self.guest_periods))
            return True
        first = len(self.periods)
        if not believable(float(self.par[0]["out_of_range"]), torque, priority):
            priority = math.nan
        served_now = int(self.state[SERVED]) - 1 - first
        place = place_to_give(self.kept[first:], self.requests[first:], served_now, priority)
        if place is None:
            return False
        row = first + place
        # A place keeps its number, and the names stay in the order of the places.
        self.guests = {name if at == row else guest: at for guest, at in self.guests.items()}
        self.kept[row] = _unheard(1)[0]
        self.rhythms[place] = Rhythm(*self.guest_periods)
        return True


def overlay_record(parameters: ParameterSet) -> np.ndarray:
    """Return the record, shape (1,), of the arbiter's kernels.

    Beside the data sheet's group: pressure_gain R_T/A_p [Pa per N m], the constants of
    ``lateral_gain`` and those of the filters.
    """
    values: dict[str, Any] = parameters.group("overlay")
    if values["override_full"] <= values["override_start"]:
        raise ParameterError("overlay.override_full must be greater than overlay.override_start")
    mechanics = parameters.group("mechanics")
    lowpass = values["hand_torque_lowpass"]
    weight = -np.expm1(-TICK_PERIOD / lowpass)
    values |= lateral_fields(parameters)
    values |= {
        "pressure_gain": mechanics["gear_ratio"] / mechanics["piston_area"],
        "steering_wheel_damping": mechanics["steering_wheel_damping"],
        "hand_weight": weight,
        "hand_inertia_rate": mechanics["steering_wheel_inertia"]
        * weight
        / ((1.0 - weight) * TICK_PERIOD),
        "fade_step": TICK_PERIOD / values["fade_time"],
    }
    return record(values)


def guest_periods(parameters: ParameterSet) -> tuple[float, float]:
    """Return the shortest and longest period [ticks] that a guest is believed to have."""
    shortest = parameters["overlay.guest_period"] * TICKS_PER_SECOND
    longest = parameters["overlay.longest_guest_period"] * TICKS_PER_SECOND
    if longest < shortest:
        raise ParameterError(
            "overlay.longest_guest_period must not be less than overlay.guest_period"
        )
    return shortest, longest


def _unheard(count: int) -> np.ndarray:
    kept = np.zeros((count, 6))
    kept[:, [HEARD, SEEN]] = -1.0
    return kept
