"""The plant driven by measured signals: some of its states prescribed, the others integrated.

A prescribed state follows its measurement, a cubic Hermite curve from tick to tick; the remaining
right-hand side is the plant's own, effects included. The replay prescribes the steering wheel; the
balances prescribe all that was measured. Explicit Runge-Kutta 3(2) of Bogacki and Shampine (1989):
the states that are left are smooth against the sensors' noise, so a low order with a step bound by
stability is cheapest.
"""

from __future__ import annotations

import math

from steering_core.compiled import kernel
from steering_plant.model.dynamics import possible, rates, rates_between_pressures, settle
from steering_plant.model.mechanics import torsion_bar_torque
from steering_plant.model.slots import (
    left_command,
    right_command,
    sampled_states,
    supply_pressure,
)
from steering_plant.model.states import (
    ANGLE,
    LEFT_SOLENOID,
    LOAD_FORCE,
    POSITION,
    PUMP,
    RIGHT_SOLENOID,
)

WORK_ROWS = 6
"""Rows of the work array: four slopes, the new state and the stage's state."""

EXTRA = 5
"""Columns of the trace behind state and rates: torque, supply pressure, three flows."""

TICK = 1e-3
SMALLEST_STEP = 1e-8
ROUNDED = 1e-13
"""Share of an input that two ways to the same number may differ by."""
MOST_STEPS = 5000
SAFETY, LEAST_FACTOR, GREATEST_FACTOR = 0.85, 0.2, 3.0
SMALL_ERROR = (SAFETY / GREATEST_FACTOR) ** 3
OK, FAILED = 0, 1


@kernel
def prescribe(y, at, given, slopes, tick, share):
    """Write the prescribed states into ``y`` at ``share`` (0 to 1) of the tick after ``tick``.

    at: int64, their positions, shape (m,). given, slopes: values and rates at ticks, (n, m).
    """
    rest = 1.0 - share
    for j in range(at.shape[0]):
        first, last = given[tick, j], given[tick + 1, j]
        bend = rest * (TICK * slopes[tick, j] - (last - first))
        bend -= share * (TICK * slopes[tick + 1, j] - (last - first))
        y[at[j]] = first + share * (last - first) + share * rest * bend


@kernel
def slope(p, table, e, valves, time, y, u, dy, flows):
    """Fill ``dy`` [1/s]; without the valves' commands the hydraulics rests."""
    if valves:
        rates(p, table, e, time, y, u, dy, flows)
    else:
        rates_between_pressures(p, e, time, y, u, dy, flows)


@kernel
def stand(at, given, slopes, held, rise, tick, share, y, u):
    """Write what is given at ``share`` of a tick: prescribed states, and the load's force."""
    prescribe(y, at, given, slopes, tick, share)
    u[LOAD_FORCE] = held[tick, LOAD_FORCE] + share * rise[tick]


@kernel
def goes_on(held, u, tick):
    """Return whether the inputs of a tick are those that the one before it ended with."""
    same = True
    for i in range(u.shape[0]):
        same = same and abs(held[tick, i] - u[i]) <= ROUNDED * abs(u[i])
    return same


@kernel
def unchanged(y, other):
    """Return whether two states are the same."""
    same = True
    for i in range(y.shape[0]):
        same = same and y[i] == other[i]
    return same


@kernel
def keep(p, e, y, dy, flows, time, row):
    """Write state, rates and what follows from them into a row of the trace."""
    n = y.shape[0]
    for i in range(n):
        row[i], row[n + i] = y[i], dy[i]
    row[2 * n] = torsion_bar_torque(p, y, e)
    if p.closed_centre > 0.0 or p.servo_valve > 0.0:
        row[2 * n + 1] = supply_pressure(p.supply_pressure, time, y, e)
    else:
        row[2 * n + 1] = y[PUMP]
    for i in range(3):
        row[2 * n + 2 + i] = flows[i]


@kernel
def simulate(
    par, table, e, valves, scale, at, given, slopes, lead, held, rise, y, u, work, flows, trace
):
    """Integrate over all ticks and fill ``trace``; return (status, tick reached).

    par, table, e: of the plant. valves: whether their commands are known; where they are not, both
    chambers' pressures are prescribed and the hydraulics rests. scale: error allowed in one inner
    step, by state, infinite for prescribed ones. at, given, slopes: prescribed states
    (``prescribe``). lead: ticks before time zero. held: inputs of the plant, held from tick to
    tick, (n, 7). rise: what the load's force grows by within each tick, (n,). y: state to begin
    with, replaced. u, work, flows: room. trace: (n, 2 states + EXTRA), see ``keep``.
    """
    p = par[0]
    k1, k2, k3, k4, new, stage = work[0], work[1], work[2], work[3], work[4], work[5]
    n, ticks = y.shape[0], given.shape[0]
    step, known = 1.0, False
    for tick in range(ticks):
        time = (tick - lead) * TICK
        if not (known and goes_on(held, u, tick)):
            for i in range(u.shape[0]):
                u[i] = held[tick, i]
            sampled_states(y, u, e)
            u[LEFT_SOLENOID] = left_command(u[LEFT_SOLENOID], y, e)
            u[RIGHT_SOLENOID] = right_command(u[RIGHT_SOLENOID], y, e)
            last = tick + 1 == ticks
            stand(at, given, slopes, held, rise, tick - last, 1.0 if last else 0.0, y, u)
            slope(p, table, e, valves, time, y, u, k1, flows)
        keep(p, e, y, k1, flows, time, trace[tick])
        if tick + 1 == ticks:
            break
        done, steps = 0.0, 0
        while done < 1.0:
            steps += 1
            if steps > MOST_STEPS:
                return FAILED, tick
            share = (1.0 - done) / math.ceil((1.0 - done) / step * (1.0 - 1e-9))
            h = share * TICK
            for i in range(n):
                stage[i] = y[i] + 0.5 * h * k1[i]
            middle = done + 0.5 * share
            stand(at, given, slopes, held, rise, tick, middle, stage, u)
            slope(p, table, e, valves, time + middle * TICK, stage, u, k2, flows)
            for i in range(n):
                stage[i] = y[i] + 0.75 * h * k2[i]
            middle = done + 0.75 * share
            stand(at, given, slopes, held, rise, tick, middle, stage, u)
            slope(p, table, e, valves, time + middle * TICK, stage, u, k3, flows)
            for i in range(n):
                new[i] = y[i] + h * (2.0 * k1[i] + 3.0 * k2[i] + 4.0 * k3[i]) / 9.0
            end = min(done + share, 1.0)
            stand(at, given, slopes, held, rise, tick, end, new, u)
            slope(p, table, e, valves, time + end * TICK, new, u, k4, flows)
            error = math.inf
            if possible(p, new):
                error = 0.0
                for i in range(scale.shape[0]):
                    local = -5.0 * k1[i] / 72.0 + k2[i] / 12.0 + k3[i] / 9.0 - 0.125 * k4[i]
                    error = max(error, abs(h * local) / scale[i])
            if not error <= 1.0:
                shrink = SAFETY * error ** (-1.0 / 3.0) if error < math.inf else 0.0
                step = share * max(LEAST_FACTOR, shrink)
                if step * TICK < SMALLEST_STEP:
                    return FAILED, tick
                continue
            growth = SAFETY * error ** (-1.0 / 3.0) if error > SMALL_ERROR else GREATEST_FACTOR
            step = min(share * growth, 1.0)
            done = 1.0 if end > 1.0 - 1e-9 else end
            for i in range(n):
                y[i], k1[i] = new[i], k4[i]
            settle(p, e, y)
        known = not valves and unchanged(y, new)
    return OK, ticks - 1


@kernel
def torques(par, e, y, angle, position, torque):
    """Fill ``torque`` (n,) [N m] of the torsion bar at ``angle`` [rad] and ``position`` [m]."""
    for k in range(angle.shape[0]):
        y[ANGLE], y[POSITION] = angle[k], position[k]
        torque[k] = torsion_bar_torque(par[0], y, e)
