"""The whole steering loop, linear and sampled: gear, both valves, both controllers.

Around an operating point (torsion-bar torque and rack speed) the gear and the unabridged linear
valves (spool, control chamber, chamber) are one linear system behind two held demands; the
controllers are linear as well, since their schedule acts on the control error only.
"""

from __future__ import annotations

import numpy as np

from pressure_control.compensator import compensator_gains, desired_resonance
from pressure_control.operating_point import (
    PLANT_SIZE,
    SPEED,
    VALVES,
    VELOCITY,
    SteeringPoint,
)
from steering_core.ticks import TICK_PERIOD


def loop_matrix(
    point: SteeringPoint, resonance: float, damping: float, delay: int = 0
) -> np.ndarray:
    """Return the transition matrix of one tick, driver included.

    States: gear and valves (12), slip filter, then integrator and low-passed error of the right
    and of the left controller, then both demands on their way to the valves, the latest first,
    then the torque's low-pass, and with delay compensation each controller's answers.
    delay: ticks from measurement to command, both ways added.
    """
    p = point.record
    ahead = int(p["delay_compensation"])
    kept = ahead + 1 if ahead else 0
    filter_row = PLANT_SIZE + 5 + 2 * delay
    size = filter_row + 1 + 2 * kept
    wheel, slip, torque = np.zeros(size), np.zeros(size), np.zeros(size)
    torque[:PLANT_SIZE] = p["torque_weight"] * point.torque_row
    torque[filter_row] = 1.0 - p["torque_weight"]
    wheel[SPEED] = 1.0 / p["gear_ratio"]
    slip[PLANT_SIZE] = 1.0 - p["slip_weight"]
    slip[VELOCITY] = p["slip_weight"]
    slip -= p["slip_weight"] * wheel

    matrix = np.zeros((size, size))
    matrix[PLANT_SIZE], matrix[filter_row] = slip, torque
    demands = []
    for number, chamber in enumerate(point.chambers):
        w_k = desired_resonance(p, resonance, chamber.load_pressure)
        gains = compensator_gains(w_k, damping, *chamber.poles)
        direct, filtered, integral_weight, error_weight = gains
        error = chamber.by_torque * torque + chamber.by_speed * (wheel + slip)
        error[VALVES[number] + 3] -= 1.0
        row = PLANT_SIZE + 1 + 2 * number
        if ahead:
            first = filter_row + 1 + kept * number
            answer = np.zeros(size)
            answer[first], answer[row + 1] = 1.0, -0.25 / damping**2
            error -= answer
            error[first + ahead] += 1.0
            matrix[first] = 0.5 * w_k / damping * TICK_PERIOD * error
            matrix[first, first] += 1.0
            matrix[first + 1] = answer
            matrix[first + 2 : first + kept, first + 1 : first + ahead] = np.eye(ahead - 1)
        matrix[row] = integral_weight * error
        matrix[row, row] += 1.0
        matrix[row + 1] = error_weight * error
        matrix[row + 1, row + 1] += 1.0 - error_weight
        demand = direct * error + matrix[row] + filtered * matrix[row + 1]
        demand[VALVES[number] + 3] += chamber.feed_forward_by_pressure
        demands.append(demand + chamber.feed_forward_by_speed * wheel)

    rows = np.array(demands)
    if delay:
        matrix[PLANT_SIZE + 5 : PLANT_SIZE + 7] = rows
        late = slice(PLANT_SIZE + 7, filter_row)
        matrix[late, PLANT_SIZE + 5 : filter_row - 2] = np.eye(2 * (delay - 1))
        rows = np.eye(size)[filter_row - 2 : filter_row]
    matrix[:PLANT_SIZE] = point.input @ rows
    matrix[:PLANT_SIZE, :PLANT_SIZE] += point.transition
    return matrix


def spectral_radius(
    point: SteeringPoint, resonance: float, damping: float, delay: int = 0
) -> float:
    """Return the largest eigenvalue's size: below 1 the loop is stable; inf beyond all numbers."""
    with np.errstate(all="ignore"):
        matrix = loop_matrix(point, resonance, damping, delay)
    if not np.all(np.isfinite(matrix)):
        return np.inf
    return float(np.max(np.abs(np.linalg.eigvals(matrix))))
