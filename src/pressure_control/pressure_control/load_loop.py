"""The load cylinder's force loop, linear and sampled: what gain a delay allows."""

from __future__ import annotations

import numpy as np
from scipy.linalg import expm

from pressure_control.load_force import load_flow_gain, load_force_rate, load_force_record
from pressure_control.servo_record import rest_flow_pressure
from steering_core.parameters import ParameterSet
from steering_core.ticks import TICK_PERIOD

PLANT_SIZE = 8
RACK, RACK_SPEED, PISTON, PISTON_SPEED, FORCE, OPENING, OPENING_RATE, OIL = range(PLANT_SIZE)
"""FORCE [N]: of the oil on the piston, positive as the load. OIL [N]: of that in the gear."""


def load_plant(
    parameters: ParameterSet, stiffness: float
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Return A (8, 8), B (8,) and the load cell's row of (7.1) to (7.3), friction off.

    stiffness [N/m]: what holds the rack besides its damping and the oil in the steering gear, a
    spring that yields through the servo valves at rest; 1e10 is a clamp.
    """
    gear, cylinder = parameters.group("mechanics"), parameters.group("load_cylinder")
    servo, area = parameters.group("servo_valve"), cylinder["piston_area"]
    cell = np.zeros(PLANT_SIZE)
    cell[RACK], cell[PISTON] = cylinder["cell_stiffness"], -cylinder["cell_stiffness"]
    cell[RACK_SPEED], cell[PISTON_SPEED] = cylinder["cell_damping"], -cylinder["cell_damping"]
    a, b = np.zeros((PLANT_SIZE, PLANT_SIZE)), np.zeros(PLANT_SIZE)
    a[RACK, RACK_SPEED] = a[PISTON, PISTON_SPEED] = a[OPENING, OPENING_RATE] = 1.0
    a[RACK_SPEED] = -cell
    a[RACK_SPEED, OIL] = -1.0
    a[RACK_SPEED, RACK] -= stiffness
    a[RACK_SPEED, RACK_SPEED] -= gear["rack_damping"]
    a[RACK_SPEED] /= gear["rack_mass"]
    a[PISTON_SPEED] = cell
    a[PISTON_SPEED, FORCE] = -1.0
    a[PISTON_SPEED, PISTON_SPEED] -= cylinder["damping"]
    a[PISTON_SPEED] /= cylinder["piston_mass"]
    fill = parameters["oil.bulk_modulus"] / parameters["open_centre.chamber_volume"]
    a[OIL, RACK_SPEED] = 2.0 * fill * gear["piston_area"] ** 2
    a[OIL, OIL] = -fill * rest_flow_pressure(parameters)
    rate = load_force_rate(parameters)
    a[FORCE, OPENING] = rate
    a[FORCE, PISTON_SPEED] = rate * area / load_flow_gain(parameters)
    a[OPENING_RATE, OPENING] = -(servo["resonance"] ** 2)
    a[OPENING_RATE, OPENING_RATE] = -2.0 * servo["damping"] * servo["resonance"]
    b[OPENING_RATE] = servo["resonance"] ** 2
    return a, b, cell


def load_loop_matrix(parameters: ParameterSet, stiffness: float, delay: int = 0) -> np.ndarray:
    """Return the transition matrix of one tick, shape (10 + delay,) squared."""
    p = load_force_record(parameters)[0]
    a, b, cell = load_plant(parameters, stiffness)
    whole = np.zeros((PLANT_SIZE + 1, PLANT_SIZE + 1))
    whole[:PLANT_SIZE, :PLANT_SIZE], whole[:PLANT_SIZE, PLANT_SIZE] = a, b
    held = expm(whole * TICK_PERIOD)[:PLANT_SIZE]

    size = PLANT_SIZE + 2 + delay
    matrix, error = np.zeros((size, size)), np.zeros(size)
    error[:PLANT_SIZE] = -cell
    led = p["lead_gain"] * error
    led[PLANT_SIZE] += 1.0
    matrix[PLANT_SIZE] = p["lead_pole"] * led - p["lead_gain"] * p["lead_zero"] * error
    speed = np.zeros(size)
    speed[RACK_SPEED], speed[PLANT_SIZE + 1] = p["speed_weight"], 1.0 - p["speed_weight"]
    matrix[PLANT_SIZE + 1] = speed
    command = p["force_gain"] * led - p["forward_gain"] * speed
    if delay:
        matrix[PLANT_SIZE + 2] = command
        matrix[PLANT_SIZE + 3 :, PLANT_SIZE + 2 : -1] = np.eye(delay - 1)
        command = np.eye(size)[-1]
    matrix[:PLANT_SIZE] = np.outer(held[:, PLANT_SIZE], command)
    matrix[:PLANT_SIZE, :PLANT_SIZE] += held[:, :PLANT_SIZE]
    return matrix


def load_spectral_radius(parameters: ParameterSet, stiffness: float, delay: int = 0) -> float:
    """Return the largest eigenvalue's size: below 1 the force loop is stable."""
    return float(np.max(np.abs(np.linalg.eigvals(load_loop_matrix(parameters, stiffness, delay)))))


def largest_load_gain(
    parameters: ParameterSet, stiffness: float, delay: int = 0, highest: float = 1e4
) -> float:
    """Return the largest load_force_controller.gain [1/s] up to ``highest`` that is stable."""
    low, high = 0.0, highest
    for _ in range(20):
        middle = 0.5 * (low + high)
        changed = parameters.with_values({"load_force_controller.gain": middle})
        stable = load_spectral_radius(changed, stiffness, delay) < 1.0
        low, high = (middle, high) if stable else (low, middle)
    return low
