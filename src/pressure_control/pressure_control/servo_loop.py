"""The steering loop with servo valves, linear and sampled: what gain a delay allows."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from pressure_control.errors import ControllerError
from pressure_control.servo_point import (
    PAIRS,
    PLANT_SIZE,
    SPEED,
    VELOCITY,
    ServoPoint,
    servo_point,
)
from steering_core.parameters import ParameterError, ParameterSet
from steering_plant.boost_curve import FORMULA

POINTS = ((0.0, 0.0), (1.5, 0.04), (2.4, 0.0))
"""Torsion-bar torque [N m] and rack speed [m/s]: at rest, fast through the middle, at the turn of
the 20 degree sine. The rig is for on-centre driving (section 7.2)."""


def servo_loop_matrix(point: ServoPoint, gain: float, delay: int = 0) -> np.ndarray:
    """Return the transition matrix of one tick, shape (15 + 2 delay,) squared, driver included.

    gain [1/s]: servo_valve.controller_gain. delay: ticks from measurement to command, both ways
    added. States: gear and valves (10), slip filter, lag and lead of the right and of the left
    controller, then both commands on their way to the valves, the latest first.
    """
    p = point.record
    size = PLANT_SIZE + 5 + 2 * delay
    conductance = gain * p["chamber_volume"] / p["bulk_modulus"]
    wheel, slip, torque = np.zeros(size), np.zeros(size), np.zeros(size)
    torque[:PLANT_SIZE] = point.torque_row
    wheel[SPEED] = 1.0 / p["gear_ratio"]
    slip[PLANT_SIZE] = 1.0 - p["slip_weight"]
    slip[VELOCITY] = p["slip_weight"]
    slip -= p["slip_weight"] * wheel

    matrix = np.zeros((size, size))
    matrix[PLANT_SIZE] = slip
    commands = []
    for number, chamber in enumerate(point.chambers):
        pressure = PAIRS[number]
        error = chamber.by_torque * torque + chamber.by_speed * (wheel + slip)
        error[pressure] -= 1.0
        row = PLANT_SIZE + 1 + 2 * number
        matrix[row] = p["lag_weight"] * error
        matrix[row, row] += 1.0 - p["lag_leak"]
        given = error + matrix[row]
        led = p["lead_gain"] * given
        led[row + 1] += 1.0
        matrix[row + 1] = p["lead_pole"] * led - p["lead_gain"] * p["lead_zero"] * given
        flow = conductance * led
        flow += p["flow_feed_forward"] * p["piston_area"] * chamber.sign * wheel
        flow[pressure] += chamber.steady * chamber.gain_slope
        commands.append(flow / chamber.flow_gain)

    rows = np.array(commands)
    if delay:
        matrix[PLANT_SIZE + 5 : PLANT_SIZE + 7] = rows
        matrix[PLANT_SIZE + 7 :, PLANT_SIZE + 5 : -2] = np.eye(2 * (delay - 1))
        rows = np.eye(size)[-2:]
    matrix[:PLANT_SIZE] = point.input @ rows
    matrix[:PLANT_SIZE, :PLANT_SIZE] += point.transition
    return matrix


def servo_spectral_radius(point: ServoPoint, gain: float, delay: int = 0) -> float:
    """Return the largest eigenvalue's size: below 1 the loop is stable; inf beyond all numbers."""
    with np.errstate(all="ignore"):
        matrix = servo_loop_matrix(point, gain, delay)
    if not np.all(np.isfinite(matrix)):
        return np.inf
    return float(np.max(np.abs(np.linalg.eigvals(matrix))))


def servo_points(parameters: ParameterSet, table: np.ndarray = FORMULA) -> list[ServoPoint]:
    """Return the loop at all of POINTS that the valves can hold."""
    points = []
    for torque, speed in POINTS:
        try:
            points.append(servo_point(parameters, torque, speed, table))
        except ParameterError:
            continue
    return points


def largest_servo_gain(points: Sequence[ServoPoint], delay: int = 0, highest: float = 1e4) -> float:
    """Return the largest gain [1/s] up to ``highest`` that is stable at all points, or 0."""
    low, high = 0.0, highest
    for _ in range(20):
        middle = 0.5 * (low + high)
        if all(servo_spectral_radius(point, middle, delay) < 1.0 for point in points):
            low = middle
        else:
            high = middle
    return low


def check_servo_stability(
    parameters: ParameterSet, table: np.ndarray = FORMULA, delay: int = 0
) -> None:
    """Raise ControllerError where the steering loop is unstable in the linear, sampled model.

    delay: ticks declared between measurement and command, both ways added. The error names the
    gain, the worst point and the largest stable gain.
    """
    gain = parameters["servo_valve.controller_gain"]
    points = servo_points(parameters, table)
    if not points:
        supply = parameters["closed_centre.supply_pressure"]
        raise ControllerError(
            f"closed_centre.supply_pressure {supply:g} Pa is too low for the servo valves to hold "
            "any pressure of the boost curve, so nothing can be said of their stability"
        )
    radii = [servo_spectral_radius(point, gain, delay) for point in points]
    if max(radii) < 1.0:
        return
    worst = points[int(np.argmax(radii))]
    largest = largest_servo_gain(points, delay, gain)
    late = f" with {delay} ticks of delay" if delay else ""
    advice = f"at most {largest:.3g} 1/s is stable" if largest > 0.0 else "no gain is stable"
    raise ControllerError(
        f"servo_valve.controller_gain {gain:g} 1/s is unstable at 1 kHz{late} {worst.name}; "
        + advice
    )
