"""The closed loop of all cores over a range of ticks, compiled as one kernel.

The order within a tick is the lock-step contract's: measurement, commands from measurements of
the same tick (or older by the connection's delay), then the plant with the commands.
"""

from __future__ import annotations

from driver_model.lead_lag import driver_step
from pressure_control.controller import controller_step
from steering_core.compiled import kernel
from steering_plant.model.step import plant_step, report_truth
from vehicle_model.motion import vehicle_step

MEASURED, DRIVER, LEFT_VALVE, RIGHT_VALVE, LOAD, TRUTH, MOTION = range(7)
"""Positions in the tuple of traces."""

MOTION_PERIOD = 10
"""Ticks from one row of the vehicle's motion to the next (100 Hz)."""

(
    DRIVER_TORQUE_DELAY,
    LEFT_TORQUE_DELAY,
    LEFT_PRESSURE_DELAY,
    LEFT_RACK_DELAY,
    RIGHT_TORQUE_DELAY,
    RIGHT_PRESSURE_DELAY,
    RIGHT_RACK_DELAY,
    VEHICLE_RACK_DELAY,
    PLANT_DRIVER_DELAY,
    PLANT_LEFT_DELAY,
    PLANT_RIGHT_DELAY,
    PLANT_LOAD_DELAY,
) = range(12)
"""Positions of the connections in the vector of delays."""


@kernel
def delayed(trace, rest, tick, delay):
    """Return the row of ``trace`` that belongs to ``tick`` - ``delay``, or ``rest`` before it."""
    row = tick - delay
    return trace[row] if row >= 0 else rest


@kernel
def control(core, torque, pressure, rack, tick, trace):
    """Run one valve controller on rows of the measurement and keep its output."""
    par, table, state, out = core
    controller_step(
        par,
        table,
        state,
        out,
        tick,
        torque[0],
        torque[1],
        torque[2],
        pressure[3],
        pressure[4],
        pressure[5],
        rack[6],
        rack[7],
        rack[8],
    )
    trace[tick] = out


@kernel
def run_ticks(start, stop, last, plant, left, right, driver, vehicle, delays, rest, traces):
    """Run ticks ``start`` to ``stop`` - 1 and fill the traces; return (status, tick reached).

    last: number of ticks of the whole run; after its last tick the plant does not move on.
    plant, left, right, driver, vehicle: the cores' arrays. delays: int64, shape (12,). rest: rows
    that stand before the first tick. traces: see the positions above; TRUTH may have no rows.
    """
    measured, load = traces[MEASURED], traces[LOAD]
    par, table, e, y, u = plant[0], plant[1], plant[3], plant[5], plant[7]
    work, flows, out = plant[8], plant[9], plant[12]
    closed = par[0].closed_centre > 0.0
    driver_par, reference, hands_on, driver_state, driver_out = driver
    vehicle_par, external, vehicle_state, vehicle_out = vehicle
    for tick in range(start, stop):
        measured[tick] = out
        if traces[TRUTH].shape[0] > 0:
            report_truth(par, table, e, tick, y, u, work, flows, traces[TRUTH][tick])

        at = delayed(measured, rest[MEASURED], tick, delays[DRIVER_TORQUE_DELAY])
        driver_step(
            driver_par, reference, hands_on, driver_state, driver_out, tick, at[0], at[1], at[2]
        )
        traces[DRIVER][tick] = driver_out
        if closed:
            torque = delayed(measured, rest[MEASURED], tick, delays[LEFT_TORQUE_DELAY])
            pressure = delayed(measured, rest[MEASURED], tick, delays[LEFT_PRESSURE_DELAY])
            rack = delayed(measured, rest[MEASURED], tick, delays[LEFT_RACK_DELAY])
            control(left, torque, pressure, rack, tick, traces[LEFT_VALVE])
            torque = delayed(measured, rest[MEASURED], tick, delays[RIGHT_TORQUE_DELAY])
            pressure = delayed(measured, rest[MEASURED], tick, delays[RIGHT_PRESSURE_DELAY])
            rack = delayed(measured, rest[MEASURED], tick, delays[RIGHT_RACK_DELAY])
            control(right, torque, pressure, rack, tick, traces[RIGHT_VALVE])
        at = delayed(measured, rest[MEASURED], tick, delays[VEHICLE_RACK_DELAY])
        vehicle_step(
            vehicle_par, external, vehicle_state, vehicle_out, tick, at[6], at[7], at[8]
        )
        load[tick] = vehicle_out
        if tick % MOTION_PERIOD == 0:
            traces[MOTION][tick // MOTION_PERIOD] = vehicle_state

        if tick + 1 < last:
            command = delayed(traces[DRIVER], rest[DRIVER], tick, delays[PLANT_DRIVER_DELAY])
            force = delayed(load, rest[LOAD], tick, delays[PLANT_LOAD_DELAY])
            left_force, right_force = 0.0, 0.0
            if closed:
                valve = delayed(
                    traces[LEFT_VALVE], rest[LEFT_VALVE], tick, delays[PLANT_LEFT_DELAY]
                )
                left_force = valve[1]
                valve = delayed(
                    traces[RIGHT_VALVE], rest[RIGHT_VALVE], tick, delays[PLANT_RIGHT_DELAY]
                )
                right_force = valve[1]
            status = plant_step(
                *plant, tick, command[0], left_force, right_force, force[0], force[1], force[2]
            )
            if status != 0:
                return status, tick
    return 0, stop - 1
