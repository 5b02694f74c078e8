"""One tick of the plant: true outputs, measured outputs, integration with the tick's commands."""

from __future__ import annotations

from steering_core.compiled import kernel
from steering_plant.sensors import measure

from . import mechanics, slots
from .dynamics import rates
from .integrator import advance
from .states import (
    ANGLE,
    COLUMN_FRICTION,
    DRIVER_TORQUE,
    ENERGY,
    LEFT,
    LEFT_FLOW,
    LEFT_SERVO,
    LEFT_SOLENOID,
    LEFT_VALVE,
    LOAD_FORCE,
    LOAD_POSITION,
    LOAD_STIFFNESS,
    LOAD_VALVE,
    METER_IN,
    POSITION,
    PUMP,
    RACK_FRICTION,
    RIGHT,
    RIGHT_FLOW,
    RIGHT_SERVO,
    RIGHT_SOLENOID,
    RIGHT_VALVE,
    SPEED,
    SPOOL,
    SUPPLY_FLOW,
    VELOCITY,
)

TICK = 1e-3
"""Length of a tick [s]."""


@kernel
def observe(par, sensors, e, tick, y, u, history, true, out):
    """Fill ``out`` (shape (9,), order of sensors.CHANNELS) with the measurement of ``tick``.

    ``u`` holds the load that acted in the tick before, which the load cell still reports.
    """
    p = par[0]
    true[0], true[1] = y[ANGLE], y[SPEED]
    true[2] = mechanics.torsion_bar_torque(p, y, e)
    true[3], true[4] = y[LEFT], y[RIGHT]
    if p.closed_centre > 0.0 or p.servo_valve > 0.0:
        true[5] = slots.supply_pressure(p.supply_pressure, tick * TICK, y, e)
    else:
        true[5] = y[PUMP]
    true[6], true[7] = y[POSITION], y[VELOCITY]
    true[8] = mechanics.load(p, u, y, e)
    measure(sensors, p.noise_seed, history, tick, true, out)


@kernel
def report_truth(par, table, e, tick, y, u, work, flows, truth):
    """Fill ``truth`` (shape (8,), fields of steering_msgs/PlantTruth) at ``tick``."""
    p = par[0]
    rates(p, table, e, tick * TICK, y, u, work[0], flows)
    truth[0], truth[1] = y[COLUMN_FRICTION], y[RACK_FRICTION]
    truth[2], truth[3] = 0.0, 0.0
    if p.closed_centre > 0.0:
        truth[2], truth[3] = y[LEFT_VALVE + SPOOL], y[RIGHT_VALVE + SPOOL]
    elif p.servo_valve > 0.0:
        truth[2], truth[3] = y[LEFT_SERVO + METER_IN], y[RIGHT_SERVO + METER_IN]
    truth[4], truth[5] = flows[LEFT_FLOW], flows[RIGHT_FLOW]
    truth[6], truth[7] = flows[SUPPLY_FLOW], y[ENERGY]


@kernel
def plant_step(
    par,
    table,
    sensors,
    e,
    scale,
    y,
    step,
    u,
    work,
    flows,
    history,
    true,
    out,
    tick,
    driver_torque,
    left_solenoid,
    right_solenoid,
    load_force,
    load_stiffness,
    load_position,
    load_valve,
):
    """Integrate from ``tick`` to the next with the tick's commands and measure there.

    SI units. Returns the integrator's status; on success ``out`` is the measurement of tick + 1.
    """
    u[DRIVER_TORQUE] = driver_torque
    u[LEFT_SOLENOID], u[RIGHT_SOLENOID] = left_solenoid, right_solenoid
    u[LOAD_FORCE], u[LOAD_STIFFNESS], u[LOAD_POSITION] = load_force, load_stiffness, load_position
    u[LOAD_VALVE] = load_valve
    slots.sampled_states(y, u, e)
    u[LEFT_SOLENOID] = slots.left_command(u[LEFT_SOLENOID], y, e)
    u[RIGHT_SOLENOID] = slots.right_command(u[RIGHT_SOLENOID], y, e)
    status = advance(par[0], table, e, scale, tick * TICK, TICK, y, step, u, work, flows)
    if status == 0:
        observe(par, sensors, e, tick + 1, y, u, history, true, out)
    return status
