"""The closed loop of all cores over a range of ticks, compiled as one kernel.

The order within a tick is the lock-step contract's: measurement, commands from measurements of
the same tick (or older by the connection's delay), then the plant with the commands.
"""

from __future__ import annotations

from driver_model.lead_lag import driver_step
from pressure_control.controller import controller_step
from pressure_control.load_force import load_force_step
from pressure_control.overlay.arbiter import arbiter_step
from pressure_control.overlay.sources import message_tick
from pressure_control.state_places import SPOOL_SEEN
from steering_bringup.lane_keeping.keeper import lane_keeper_step
from steering_core.compiled import kernel
from steering_plant.model.states import LEFT_VALVE as LEFT_VALVE_STATES
from steering_plant.model.states import RIGHT_VALVE as RIGHT_VALVE_STATES
from steering_plant.model.states import SPOOL
from steering_plant.model.step import plant_step, report_truth
from vehicle_model.model.attitude import half_angle
from vehicle_model.model.step import vehicle_step

MEASURED, DRIVER, LEFT_VALVE, RIGHT_VALVE, LOAD, APPLIED, TRUTH, MOTION, LANE, CYLINDER = range(10)
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
    ARBITER_TORQUE_DELAY,
    ARBITER_LANE_DELAY,
    ARBITER_MOTION_DELAY,
    LEFT_OVERLAY_DELAY,
    RIGHT_OVERLAY_DELAY,
    CYLINDER_RACK_DELAY,
    CYLINDER_LOAD_DELAY,
    PLANT_CYLINDER_DELAY,
) = range(20)
"""Positions of the connections in the vector of delays."""


@kernel
def control(core, measured, torque, pressure, rack, overlay, tick, trace, row):
    """Run one valve controller on rows of the measurement and keep its output in ``row``.

    overlay [N m]: as applied.
    """
    par, table, state, out = core
    controller_step(
        par,
        table,
        state,
        out,
        tick,
        measured[torque, 0],
        measured[torque, 1],
        measured[torque, 2],
        measured[pressure, 3],
        measured[pressure, 4],
        measured[pressure, 5],
        measured[rack, 6],
        measured[rack, 7],
        measured[rack, 8],
        overlay,
    )
    keep(out, trace, row)


@kernel
def see_spool(core, y, first):
    """Hand a controller its valve's true spool displacement, if it has a place for it."""
    state = core[2]
    if state.shape[0] > SPOOL_SEEN:
        state[SPOOL_SEEN] = y[first + SPOOL]


@kernel
def keep_lane(core, vehicle_par, vehicle_state, tick, trace):
    """Run the lane keeper on the vehicle's motion, if this tick is one of its own."""
    par, lane, state, out, period = core
    if tick % period[0] == 0:
        speed = vehicle_par[0].speed
        sideslip, curvature, heading = vehicle_state[0], vehicle_state[1], vehicle_state[2]
        sine, cosine = half_angle(heading)
        x, y, v_y, yaw_rate = (
            vehicle_state[3],
            vehicle_state[4],
            speed * sideslip,
            speed * curvature,
        )
        lane_keeper_step(par, lane, state, out, tick, x, y, sine, cosine, speed, v_y, yaw_rate)
        keep(out, trace, tick // period[0])


@kernel
def arbitrate(core, lane_period, lane_delay, speed, measured, at, tick, asked, trace, row):
    """Run the arbiter; ``asked`` holds what the lane keeper published, if there is one."""
    par, state, kept, requests, longest, bounds, out = core
    if requests.shape[0] > 0:
        heard = message_tick(tick, lane_delay, lane_period)
        requests[0, 2] = heard
        if heard >= 0:
            requests[0, 0] = asked[heard // lane_period, 0]
            requests[0, 1] = asked[heard // lane_period, 1]
    arbiter_step(
        par,
        state,
        kept,
        requests,
        longest,
        bounds,
        out,
        tick,
        speed,
        measured[at, 1],
        measured[at, 2],
    )
    keep(out, trace, row)


@kernel
def keep(out, trace, row):
    """Copy ``out`` to a row of ``trace``."""
    for i in range(out.shape[0]):
        trace[row, i] = out[i]


@kernel
def run_ticks(
    start,
    stop,
    last,
    plant,
    left,
    right,
    driver,
    vehicle,
    arbiter,
    lane_keeper,
    cylinder,
    delays,
    before,
    replayed,
    traces,
):
    """Run ticks ``start`` to ``stop`` - 1 and fill the traces; return (status, tick reached).

    last: number of ticks of the whole run; after its last tick the plant does not move on.
    plant, left, right, driver, vehicle, arbiter, lane_keeper, cylinder: the cores' arrays; what has
    no trace is not there. cylinder: force control of the load cylinder. delays: int64, shape (20,).
    before:
    rows of each delayed trace that stand before tick 0 and hold what was there at rest; at least
    the longest delay. traces: see the positions above; TRUTH may have no rows. replayed: int64,
    shape (10,), by position: 1 where the trace is given and its core is not run.
    """
    measured, commanded, load = traces[MEASURED], traces[DRIVER], traces[LOAD]
    left_trace, right_trace = traces[LEFT_VALVE], traces[RIGHT_VALVE]
    truth, motion = traces[TRUTH], traces[MOTION]
    opened = traces[CYLINDER]
    applied, asked = traces[APPLIED], traces[LANE]
    overlaid, keeping = applied.shape[0] > 0, asked.shape[0] > 0
    lane_period = lane_keeper[4][0]
    par, table, e, y, u = plant[0], plant[1], plant[3], plant[5], plant[7]
    work, flows, out = plant[8], plant[9], plant[12]
    closed, loaded = left_trace.shape[0] > 0, opened.shape[0] > 0
    driver_par, reference, hands_on, driver_state, driver_out = driver
    vehicle_par, external, vehicle_e, vehicle_state, vehicle_out = vehicle
    for tick in range(start, stop):
        row = tick + before
        if not replayed[MEASURED]:
            keep(out, measured, row)
        if truth.shape[0] > 0 and not replayed[MEASURED]:
            report_truth(par, table, e, tick, y, u, work, flows, truth[tick])

        if not replayed[DRIVER]:
            at = row - delays[DRIVER_TORQUE_DELAY]
            driver_step(
                driver_par,
                reference,
                hands_on,
                driver_state,
                driver_out,
                tick,
                measured[at, 0],
                measured[at, 1],
                measured[at, 2],
            )
            keep(driver_out, commanded, row)
        if not replayed[LOAD]:
            at = row - delays[VEHICLE_RACK_DELAY]
            vehicle_step(
                vehicle_par,
                external,
                vehicle_e,
                vehicle_state,
                vehicle_out,
                tick,
                measured[at, 6],
                measured[at, 7],
                measured[at, 8],
            )
            keep(vehicle_out, load, row)
        if loaded and not replayed[CYLINDER]:
            at, wanted = row - delays[CYLINDER_RACK_DELAY], row - delays[CYLINDER_LOAD_DELAY]
            load_force_step(  # type: ignore[call-arg]
                *cylinder,
                tick,
                measured[at, 6],
                measured[at, 7],
                measured[at, 8],
                load[wanted, 0],
                load[wanted, 1],
                load[wanted, 2],
            )
            keep(cylinder[2], opened, row)
        if keeping:
            keep_lane(lane_keeper, vehicle_par, vehicle_state, tick, asked)
        if overlaid:
            at, speed = row - delays[ARBITER_TORQUE_DELAY], vehicle_par[0].speed
            late = delays[ARBITER_LANE_DELAY]
            arbitrate(arbiter, lane_period, late, speed, measured, at, tick, asked, applied, row)
        if closed and not replayed[LEFT_VALVE]:
            at_torque = row - delays[LEFT_TORQUE_DELAY]
            at_pressure = row - delays[LEFT_PRESSURE_DELAY]
            at_rack = row - delays[LEFT_RACK_DELAY]
            torque = applied[row - delays[LEFT_OVERLAY_DELAY], 1] if overlaid else 0.0
            see_spool(left, y, LEFT_VALVE_STATES)
            control(left, measured, at_torque, at_pressure, at_rack, torque, tick, left_trace, row)
        if closed and not replayed[RIGHT_VALVE]:
            at_torque = row - delays[RIGHT_TORQUE_DELAY]
            at_pressure = row - delays[RIGHT_PRESSURE_DELAY]
            at_rack = row - delays[RIGHT_RACK_DELAY]
            torque = applied[row - delays[RIGHT_OVERLAY_DELAY], 1] if overlaid else 0.0
            see_spool(right, y, RIGHT_VALVE_STATES)
            control(
                right, measured, at_torque, at_pressure, at_rack, torque, tick, right_trace, row
            )
        if tick % MOTION_PERIOD == 0:
            for i in range(motion.shape[1]):
                motion[tick // MOTION_PERIOD, i] = vehicle_state[i]

        if tick + 1 < last and not replayed[MEASURED]:
            left_force, right_force = 0.0, 0.0
            if closed:
                left_force = left_trace[row - delays[PLANT_LEFT_DELAY], 1]
                right_force = right_trace[row - delays[PLANT_RIGHT_DELAY], 1]
            command = commanded[row - delays[PLANT_DRIVER_DELAY], 0]
            at = row - delays[PLANT_LOAD_DELAY]
            force, stiffness, position = load[at, 0], load[at, 1], load[at, 2]
            valve = opened[row - delays[PLANT_CYLINDER_DELAY], 1] if loaded else 0.0
            status = plant_step(  # type: ignore[call-arg]
                *plant, tick, command, left_force, right_force, force, stiffness, position, valve
            )
            if status != 0:
                return status, tick
    return 0, stop - 1
