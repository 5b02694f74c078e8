"""Pressure controller of one chamber with servo valves: boost curve, lead-lag, flow feed-forward.

    G(s) = K_p0/K_q (T s + 1)/(T s + gamma) (T_d s + 1)/(alpha T_d s + 1), T = V/(beta K_c) (7.15)

The first fraction lags (gamma below 1: its pole lies below its zero; at 0 it is the integrator
that the static boost curve needs) and its zero cancels the chamber's pole. The second leads (alpha
below 1). The loop of (7.10) is then K_p0 beta/V / s behind the spools. What (7.15) lacks is the
load flow, which disturbs the loop by 1/(K_c + V/beta s) as (7.11) has it: flow_feed_forward opens
the valves for it. Like the other controller it works as the right chamber's; ``side`` turns the
signs.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from pressure_control.limits import bounded
from pressure_control.record import Side
from pressure_control.reference import (
    SPEED_LIMIT,
    compensation_speed,
    mirrored,
    reference_pressures,
)
from pressure_control.servo_loop import check_servo_stability
from pressure_control.servo_record import flow_gain, servo_controller_record
from steering_core.compiled import kernel
from steering_core.parameters import ParameterSet
from steering_core.ticks import TICK_PERIOD
from steering_plant.boost_curve import FORMULA

LAG, LEAD, SLIP = range(3)
"""States: lag's [Pa], lead's [Pa], low-passed speed difference [m/s]."""


@kernel
def lead_lag(p: Any, state: np.ndarray, error: float) -> tuple[float, float]:
    """Return ((7.15) of an error without K_p0/K_q [Pa], the lag's next state [Pa]).

    The lag is 1 + (1 - gamma)/(T s + gamma) and takes in the present error before it is used; the
    lead has its zero and pole where the continuous one's go at the sampling period.
    """
    lag = state[LAG] + p.lag_weight * error - p.lag_leak * state[LAG]
    given = error + lag
    led = p.lead_gain * given + state[LEAD]
    state[LEAD] = p.lead_pole * led - p.lead_gain * p.lead_zero * given
    return led, lag


@kernel
def square_wave(p: Any, tick: int) -> float:
    """Return the test's reference [Pa] at a tick: low, then high and low in turn (§8.3.1)."""
    since = tick * TICK_PERIOD - p.test_start
    if since < 0.0 or since % p.test_period >= 0.5 * p.test_period:
        return p.test_low
    return p.test_high


@kernel
def controller_step(
    par: np.ndarray,
    table: np.ndarray,
    state: np.ndarray,
    out: np.ndarray,
    tick: int,
    angle: float,
    speed: float,
    torque: float,
    left: float,
    right: float,
    supply: float,
    rack_x: float,
    rack_v: float,
    rack_force: float,
    overlay: float,
) -> None:
    """Advance one tick: out = [reference pressure Pa, command of both valves -1 to 1].

    Inputs as measured at this tick; overlay [N m]: as applied by the arbiter. Finite inputs give
    finite outputs within the limits.
    """
    p = par[0]
    highest = bounded(supply, 2.0 * p.atmospheric_pressure, 2.0 * p.supply_pressure)
    pressure = bounded(right if p.side > 0.0 else left, 0.0, highest)
    wheel_v = bounded(p.side * speed / p.gear_ratio, -SPEED_LIMIT, SPEED_LIMIT)
    rack_v = bounded(p.side * rack_v, -SPEED_LIMIT, SPEED_LIMIT)

    load_v, state[SLIP] = compensation_speed(p, state[SLIP], wheel_v, rack_v)
    reference, _ = reference_pressures(
        p, table, p.side * torque, p.piston_area * load_v, highest, p.side * overlay
    )
    if p.test_period > 0.0:
        reference = square_wave(p, tick)
    working = bounded(pressure, p.atmospheric_pressure, highest - p.atmospheric_pressure)
    per_flow = 1.0 / flow_gain(p, working, highest)
    led, lag = lead_lag(p, state, reference - pressure)
    forward = p.flow_feed_forward * p.piston_area * wheel_v
    wanted = p.rest_command + (p.controller_conductance * led + forward) * per_flow
    command = bounded(wanted, -1.0, 1.0)
    # At a limit the lag takes nothing in that would drive on.
    if wanted == command or (lag - state[LAG]) * wanted < 0.0:
        state[LAG] = lag
    out[0] = reference
    out[1] = command


class ServoValveController:
    """Pressure controller of one chamber with servo valves, with its parameters and states.

    side: "left" or "right". boost_table: a measured boost curve (measured_boost_curve) in
    place of the formula. At first ``out`` holds the gear's rest. Raises ControllerError where
    the sampled loop would be unstable.
    """

    valve_system = "servo_valve"
    check_stability = staticmethod(check_servo_stability)

    def __init__(
        self, parameters: ParameterSet, side: Side, boost_table: np.ndarray | None = None
    ) -> None:
        if side not in ("left", "right"):
            raise ValueError(f"the side of a valve controller is 'left' or 'right', not '{side}'")
        table = FORMULA if boost_table is None else boost_table
        check_servo_stability(parameters, table)
        self.par = servo_controller_record(parameters, side, table)
        self.table = table if side == "right" else mirrored(table)
        self.state = np.zeros(3)
        supply = float(self.par[0]["supply_pressure"])
        pressure, _ = reference_pressures(self.par[0], self.table, 0.0, 0.0, supply)
        self.out = np.array([pressure, self.par[0]["rest_command"]])

    def step(
        self,
        tick: int,
        angle: float,
        speed: float,
        torque: float,
        left: float,
        right: float,
        supply: float,
        rack_x: float,
        rack_v: float,
        rack_force: float,
        overlay: float = 0.0,
    ) -> np.ndarray:
        """Return ``out`` = [reference pressure Pa, command -1 to 1] for one tick's measurement.

        Units and signs of the inputs: SteeringTorque, ChamberPressure, RackState, and ``applied``
        of TorqueOverlayApplied.
        """
        controller_step(
            self.par,
            self.table,
            self.state,
            self.out,
            tick,
            angle,
            speed,
            torque,
            left,
            right,
            supply,
            rack_x,
            rack_v,
            rack_force,
            overlay,
        )
        return self.out
