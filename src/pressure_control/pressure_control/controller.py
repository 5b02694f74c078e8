"""The chamber pressure controller: reference, compensator, feed-forward and limits.

One object a chamber. It works as the right chamber's controller throughout; ``side`` = -1 turns
the signs of what it measures, so left and right are each other's exact mirror image.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from pressure_control.compensator import compensator_gains, desired_resonance
from pressure_control.limits import bounded
from pressure_control.prediction import pending_answer
from pressure_control.record import Side, controller_record
from pressure_control.reference import (
    SPEED_LIMIT,
    compensation_speed,
    mirrored,
    reference_pressures,
)
from pressure_control.schedule import (
    flow_feed_forward,
    opening_at,
    opening_for_flow,
    scheduled_poles,
)
from pressure_control.servo_controller import ServoValveController
from pressure_control.stability import check_sampled_stability
from pressure_control.state_places import (
    ANSWER,
    FILTERED,
    INTEGRAL,
    SLIP,
    SPOOL_SEEN,
    STATES,
    TORQUE,
)
from steering_core.compiled import kernel
from steering_core.parameters import ParameterSet
from steering_plant.boost_curve import FORMULA
from steering_plant.rest import rest_solenoid_force


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
    """Advance one tick: out = [reference pressure Pa, solenoid force N].

    Inputs as measured at this tick; overlay [N m]: as applied by the arbiter. Finite inputs give
    finite outputs within the limits.
    """
    p = par[0]
    highest = bounded(supply, 2.0 * p.atmospheric_pressure, 2.0 * p.supply_pressure)
    pressure = bounded(right if p.side > 0.0 else left, 0.0, highest)
    wheel_v = bounded(p.side * speed / p.gear_ratio, -SPEED_LIMIT, SPEED_LIMIT)
    rack_v = bounded(p.side * rack_v, -SPEED_LIMIT, SPEED_LIMIT)

    load_v, state[SLIP] = compensation_speed(p, state[SLIP], wheel_v, rack_v)
    torque = p.side * filtered_torque(p, state, torque)
    reference, load_pressure = reference_pressures(
        p, table, torque, p.piston_area * load_v, highest, p.side * overlay
    )
    # What the valve's gains are computed for keeps clear of the ends, where one edge has none.
    working = bounded(pressure, p.atmospheric_pressure, highest - p.atmospheric_pressure)
    flow = p.piston_area * wheel_v
    area, depth, drop = opening_for_flow(p, working, highest, flow)
    seen_flow, seen_area, seen_depth = flow, area, depth
    if p.spool_sensor > 0.0:
        seen_flow, seen_area, seen_depth = opening_at(p, state[SPOOL_SEEN])
    w_0, d_0, K_s = scheduled_poles(
        p, working, highest, seen_flow, seen_area, seen_depth, p.side * rack_x
    )
    w_k = desired_resonance(p, p.resonance, load_pressure)
    direct, filtered, integral_weight, error_weight = compensator_gains(
        w_k, p.damping, w_0, d_0, K_s
    )

    error = reference - pressure
    if p.delay_compensation > 0.0:
        error -= pending_answer(p, state, tick)
        state[ANSWER] += integral_weight * K_s * error
    state[FILTERED] += error_weight * (error - state[FILTERED])
    rest = direct * error + filtered * state[FILTERED]
    rest += flow_feed_forward(p, flow, area, depth, drop)
    out[0] = reference
    out[1] = limited_force(p, state, integral_weight * error, rest)


@kernel
def filtered_torque(p: Any, state: np.ndarray, torque: float) -> float:
    """Return the torque [N m] behind the low-pass, if there is one."""
    if p.torque_weight < 1.0:
        state[TORQUE] += p.torque_weight * (torque - state[TORQUE])
        return float(state[TORQUE])
    return torque


@kernel
def limited_force(p: Any, state: np.ndarray, increment: float, rest: float) -> float:
    """Integrate by ``increment`` [Pa] and return the force (5.1) F = e A_c + f_0 [N].

    rest [Pa]: the demand without the integrator. The force stays within what a solenoid can push;
    an error that drives on at a limit fills the integrator up to the limit and no further.
    """
    lowest = -p.spring_preload / p.pressure_area
    highest = (p.maximum_solenoid_force - p.spring_preload) / p.pressure_area
    integral = state[INTEGRAL]
    if increment > 0.0:
        integral = min(integral + increment, max(integral, highest - rest))
    else:
        integral = max(integral + increment, min(integral, lowest - rest))
    state[INTEGRAL] = bounded(integral, lowest, highest)
    demand = bounded(state[INTEGRAL] + rest, lowest, highest)
    return bounded(demand * p.pressure_area + p.spring_preload, 0.0, p.maximum_solenoid_force)


class ValveController:
    """Pressure controller of one chamber with its parameters and states.

    side: "left" or "right". boost_table: a measured boost curve (measured_boost_curve) in
    place of the formula. At first ``out`` holds the gear's rest: no torque, no load, the static
    map's pressure. Raises ControllerError where the sampled loop would be unstable.
    """

    valve_system = "closed_centre"
    check_stability = staticmethod(check_sampled_stability)

    def __init__(
        self, parameters: ParameterSet, side: Side, boost_table: np.ndarray | None = None
    ) -> None:
        if side not in ("left", "right"):
            raise ValueError(f"the side of a valve controller is 'left' or 'right', not '{side}'")
        table = FORMULA if boost_table is None else boost_table
        check_sampled_stability(parameters, table)
        self.par = controller_record(parameters, side, table)
        self.table = table if side == "right" else mirrored(table)
        self.state = np.zeros(STATES)
        self.out = np.array(rest_output(self.par, self.table))
        p = self.par[0]
        self.state[INTEGRAL] = (self.out[1] - p["spring_preload"]) / p["pressure_area"]

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
        """Return ``out`` = [reference pressure Pa, solenoid force N] for one tick's measurement.

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


CONTROLLERS: dict[str, Any] = {
    "pressure_control_valve": ValveController,
    "servo_valve": ServoValveController,
}
"""Controllers by kind, each called as ``kind(parameters, side, boost_table)``. Register here.

``valve_system``: what it drives; ``check_stability(parameters, boost_table, delay)`` raises where
it cannot work. One with ``par``, ``table``, ``state`` and ``out``, and a kernel ``controller_step``
in its module, runs without ROS as well.
"""


def rest_output(par: np.ndarray, table: np.ndarray) -> tuple[float, float]:
    """Return (reference pressure [Pa], solenoid force [N]) at rest: no torque, no flow.

    The force holds the pressure against the spool's spring and flow forces, so that a plant that
    starts in its equilibrium stays there.
    """
    p = par[0]
    pressure, _ = reference_pressures(p, table, 0.0, 0.0, float(p["supply_pressure"]))
    force = rest_solenoid_force(p, float(pressure))
    return float(pressure), min(force, float(p["maximum_solenoid_force"]))
