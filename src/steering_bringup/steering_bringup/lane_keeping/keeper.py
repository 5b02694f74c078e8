"""The lane keeper: where the lane is, which curvature leads back to it, which torque that takes.

As a camera would, it looks at the lane's offset and direction a short way ahead. The wanted
curvature

    kappa = kappa_lane - (k_y e + k_psi (psi - psi_lane) + k_i integral of e) / v

becomes a torque by the tyres' steady aligning moment, a_y = v^2 kappa = gain T, and the yaw rate
that is still missing adds to it.
"""

from __future__ import annotations

import math

import numpy as np

from pressure_control.overlay.lateral import lateral_fields
from steering_bringup.lane_keeping.lane import lane_at, lane_table
from steering_core.compiled import kernel
from steering_core.parameters import ParameterSet, record
from steering_core.ticks import TICK_PERIOD

ALONG, INTEGRAL = range(2)
"""States: distance along the lane [m], integral of the offset [m s]."""


@kernel
def lane_keeper_step(par, lane, state, out, tick, x, y, sine, cosine, v_x, v_y, yaw_rate):
    """Advance one step: out = [torque N m, priority].

    x, y [m], sine and cosine of half the heading, v_x, v_y [m/s] and yaw_rate [rad/s]: odometry.
    """
    p = par[0]
    heading = 2.0 * math.atan2(sine, cosine)
    lane_x, lane_y, along, _ = lane_at(lane, state[ALONG])
    state[ALONG] += (x - lane_x) * math.cos(along) + (y - lane_y) * math.sin(along)
    lane_x, lane_y, along, _ = lane_at(lane, state[ALONG])
    offset = (y - lane_y) * math.cos(along) - (x - lane_x) * math.sin(along)
    v = max(v_x, p.slowest_speed)
    course = heading + v_y / v - along
    course = math.atan2(math.sin(course), math.cos(course))
    _, _, _, curvature = lane_at(lane, state[ALONG] + p.preview_time * v)

    lost = abs(offset) > p.largest_offset or v_x < p.slowest_speed
    if lost:
        state[INTEGRAL] = 0.0
    elif abs(offset) < p.integral_offset:  # farther off a driver wants it so, or it is on its way
        integral = state[INTEGRAL] + offset * p.step_time
        state[INTEGRAL] = min(max(integral, -p.largest_integral), p.largest_integral)
    back = p.offset_gain * offset + p.course_gain * course + p.integral_gain * state[INTEGRAL]
    wanted = curvature - back / v
    torque = v * v * wanted / p.torque_gain + p.yaw_rate_gain * (v * wanted - yaw_rate)
    out[0] = min(max(torque, -p.largest_torque), p.largest_torque)
    out[1] = -1.0 if lost else p.priority


class LaneKeeper:
    """The lane keeper with its parameters, lane and states.

    period [ticks]: from one step to the next. At more than largest_offset from the lane, or below
    slowest_speed, it stands by.
    """

    def __init__(self, parameters: ParameterSet, period: int = 10) -> None:
        self.par = keeper_record(parameters, period)
        self.lane = lane_table(parameters)
        self.period = period
        self.state = np.zeros(2)
        self.out = np.array([0.0, -1.0])

    def step(
        self,
        tick: int,
        x: float,
        y: float,
        sine: float,
        cosine: float,
        v_x: float,
        v_y: float,
        yaw_rate: float,
    ) -> np.ndarray:
        """Return ``out`` = [torque N m, priority] for the odometry of ``tick``."""
        lane_keeper_step(
            self.par,
            self.lane,
            self.state,
            self.out,
            tick,
            x,
            y,
            sine,
            cosine,
            v_x,
            v_y,
            yaw_rate,
        )
        return self.out


def keeper_record(parameters: ParameterSet, period: int) -> np.ndarray:
    """Return the record, shape (1,), of ``lane_keeper_step`` for a step each ``period`` ticks.

    Beside the data sheet's group: step_time [s], torque_gain [m/s2 per N m].
    """
    values = parameters.group("lane_keeping")
    values["step_time"] = period * TICK_PERIOD
    values["torque_gain"] = lateral_fields(parameters)["torque_gain"]
    return record(values)
