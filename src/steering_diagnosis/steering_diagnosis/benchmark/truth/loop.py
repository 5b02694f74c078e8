"""The truth's closed loop over a record: gear, sensors, driver, vehicle and valve controllers."""

from __future__ import annotations

from math import exp, floor, isfinite

from driver_model.lead_lag import driver_step
from pressure_control.controller import controller_step
from steering_core.compiled import kernel
from vehicle_model.model.step import vehicle_step

from . import states as s
from .gear import column, load, substep, torsion

TICK = 1e-3
STAGES = 4
PLAYS = 4


@kernel
def true_values(p, y, u, true):
    """Fill ``true`` (9,) with what ideal sensors would report."""
    true[s.ANGLE_OUT], true[s.SPEED_OUT] = y[s.ANGLE], y[s.SPEED]
    true[s.TORQUE_OUT] = torsion(p, y)
    true[s.LEFT_OUT], true[s.RIGHT_OUT], true[s.SUPPLY_OUT] = y[s.LEFT], y[s.RIGHT], y[s.SUPPLY]
    true[s.RACK_OUT], true[s.RACK_SPEED_OUT] = y[s.RACK], y[s.RACK_SPEED]
    true[s.FORCE_OUT] = load(p, y, u)


@kernel
def age(delays, chain, true, h):
    """Move the sensors' delays on: each a chain of equal lags whose times add up to it.

    chain: (9, 1 + STAGES), true value and each lag's output ``h`` ago. A lag's answer to an input
    that runs straight over the step is exact: a ramp comes out late by the delay, neither more nor
    less.
    """
    for i in range(s.CHANNELS):
        if delays[i, 0] <= 0.0:
            continue
        stages = int(delays[i, 1])
        lag = delays[i, 0] / stages
        keep = exp(-h / lag)
        came, comes = chain[i, 0], true[i]
        chain[i, 0] = comes
        for k in range(1, stages + 1):
            # Behind a ramp by lag times slope, and what differed from that dies away.
            behind = lag * (comes - came) / h
            here = comes - behind + keep * (chain[i, k] - came + behind)
            came, comes = chain[i, k], here
            chain[i, k] = here


@kernel
def measure(p, sensors, delays, chain, true, noise, row, measured):
    """Fill a row of ``measured``: aged value, cross-talk, gain, offset, noise, resolution."""
    for i in range(s.CHANNELS):
        value = true[i]
        if delays[i, 0] > 0.0:
            value = chain[i, int(delays[i, 1])]
        if i == s.LEFT_OUT:
            value += p.crosstalk * true[s.RIGHT_OUT]
        value = sensors[i, 0] * value + sensors[i, 1] + noise[row, i]
        if sensors[i, 2] > 0.0:
            value = sensors[i, 2] * floor(value / sensors[i, 2] + 0.5)
        measured[row, i] = value


@kernel
def played(p, plays, side, command):
    """Return a solenoid's command after hysteresis: plays of several widths side by side."""
    if p.magnet_width <= 0.0:
        return command
    total = 0.0
    for k in range(PLAYS):
        # half widths 0.7, 0.9, 1.1, 1.3 of the mean: together as wide as magnet_width
        half = 0.5 * p.magnet_width * (0.7 + 0.2 * k)
        held = min(max(plays[side, k], command - half), command + half)
        plays[side, k] = held
        total += held
    return total / PLAYS


@kernel
def control(core, tick, m, commands):
    """Run one valve controller on a row of measurements."""
    par, table, state, out = core
    controller_step(
        par, table, state, out, tick, m[0], m[1], m[2], m[3], m[4], m[5], m[6], m[7], m[8], 0.0
    )
    commands[0], commands[1] = out[0], out[1]


@kernel
def simulate(
    par,
    steps,
    y,
    u,
    sensors,
    delays,
    chain,
    plays,
    noise,
    work,
    driver,
    vehicle,
    left,
    right,
    relaxing,
    out,
):
    """Run all ticks; return the number of ticks done (fewer where the state was lost).

    out: (true (n, 9), measured (n, 9), driver (n, 2), left (n, 2), right (n, 2), load (n, 3),
    balance (n, 2)). With ``par.clamped`` the true rows 0, 1 and 8 and all commands are given
    (with ``par.pressed`` the chambers' pressures, rows 3 and 4, as well), and balance holds the
    driver's torque that the column needs and the force beyond the load's command.
    relaxing: share of a tyre's force that builds up in a tick, 1 at once.
    """
    p = par[0]
    true, measured, commanded, left_out, right_out, loads, balance = out
    k1, k2, k3, k4, at, now = work[0], work[1], work[2], work[3], work[4], work[5]
    driver_par, reference, hands_on, driver_state, driver_out = driver
    vehicle_par, external, vehicle_e, vehicle_state, vehicle_out = vehicle
    clamped, n, tyres = p.clamped > 0.0, true.shape[0], 0.0
    h = TICK / steps
    for tick in range(n):
        if clamped:
            y[s.ANGLE], y[s.SPEED] = true[tick, 0], true[tick, 1]
            after = min(tick + 1, n - 1)
            u[s.ACCELERATION] = (true[after, 1] - true[tick, 1]) / TICK
            u[s.FORCE_IN], u[s.STIFFNESS_IN] = true[tick, 8], 0.0
            u[s.RISE] = (true[after, 8] - true[tick, 8]) / TICK
            if p.pressed > 0.0:
                y[s.LEFT], y[s.RIGHT] = true[tick, 3], true[tick, 4]
                u[s.LEFT_RISE] = (true[after, 3] - true[tick, 3]) / TICK
                u[s.RIGHT_RISE] = (true[after, 4] - true[tick, 4]) / TICK
            balance[tick, 0] = (
                p.steering_wheel_inertia * u[s.ACCELERATION] + torsion(p, y) + column(p, y)
            )
            balance[tick, 1] = y[s.LOAD_FRICTION]
        true_values(p, y, u, now)
        if tick == 0:
            for i in range(s.CHANNELS):
                for k in range(STAGES + 1):
                    chain[i, k] = now[i]
        measure(p, sensors, delays, chain, now, noise, tick, measured)
        if clamped:
            for i in range(2, 8):
                true[tick, i] = now[i]
        else:
            for i in range(s.CHANNELS):
                true[tick, i] = now[i]
            driver_step(
                driver_par,
                reference,
                hands_on,
                driver_state,
                driver_out,
                tick,
                now[0],
                now[1],
                now[2],
            )
            commanded[tick, 0], commanded[tick, 1] = driver_out[0], driver_out[1]
            m = measured[tick]
            vehicle_step(
                vehicle_par, external, vehicle_e, vehicle_state, vehicle_out, tick, m[6], m[7], m[8]
            )
            for i in range(3):
                loads[tick, i] = vehicle_out[i]
            if relaxing < 1.0:
                tyres += relaxing * (vehicle_out[0] - tyres)
                loads[tick, 0], loads[tick, 1] = tyres, relaxing * vehicle_out[1]
            if p.closed > 0.0:
                control(left, tick, m, left_out[tick])
                control(right, tick, m, right_out[tick])
            u[s.FORCE_IN], u[s.STIFFNESS_IN] = loads[tick, 0], loads[tick, 1]
            u[s.POSITION_IN] = loads[tick, 2]
        u[s.TORQUE_IN] = commanded[tick, 0]
        if p.closed > 0.0:
            u[s.LEFT_IN] = played(p, plays, 0, left_out[tick, 1])
            u[s.RIGHT_IN] = played(p, plays, 1, right_out[tick, 1])
        for k in range(steps):
            u[s.TIME] = tick * TICK + k * h
            substep(p, y, u, h, k1, k2, k3, k4, at)
            true_values(p, y, u, now)
            age(delays, chain, now, h)
        if not (isfinite(y[s.LEFT]) and isfinite(y[s.RACK]) and abs(y[s.RACK]) < 1.0):
            return tick + 1
    return n
