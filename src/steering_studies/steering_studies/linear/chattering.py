"""Chattering: the steering loop's gain too high, by the boost curve or by motion against the
assistance; predicted by the linear gear's poles and simulated.

The wheel is let go under a constant torque with friction off, which is the worst case: friction
holds small oscillations. The oscillation is rack and oil against the torsion bar, near 80 Hz.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from steering_core.parameters import ParameterError, ParameterSet
from steering_plant.linear.gear import gear_with, linear_gear
from steering_plant.linear.open_centre import OpenCentrePoint, open_centre_point, whole_model
from steering_plant.model import states
from steering_plant.plant import Plant, PlantError
from steering_studies.linear.small_signal import without_friction

LONGEST = 0.4
"""Time [s] over which growth is looked for; the rack must not reach its stop."""

DISTURBANCE = 0.02
"""Kick of the steering wheel [rad/s] that starts the oscillation."""


@dataclass(frozen=True)
class Onset:
    """Where the loop begins to oscillate. predicted and simulated in ``unit``; frequency [Hz]."""

    name: str
    torque: float
    unit: str
    predicted: float
    simulated: float
    frequency: float


def growth(point: OpenCentrePoint, parameters: ParameterSet) -> complex:
    """Return the fastest growing oscillation's pole [rad/s] of the open-centre gear, hands free."""
    poles = gear_with(whole_model(point), linear_gear(parameters, 0.0)).poles()
    fast = poles[np.abs(poles.imag) > 100.0]
    return complex(fast[np.argmax(fast.real)]) if len(fast) else complex(poles.real.max())


def gain_onset(parameters: ParameterSet, torque: float = 3.0) -> Onset:
    """Return the factor on the boost curve's slope at which a held torque [N m] chatters.

    The slope is raised through boost_rate at the same load pressure, as a tolerance of the valve
    would.
    """
    quiet = without_friction(parameters)

    def steeper(factor: float) -> ParameterSet:
        rate = quiet["open_centre.boost_rate"] * factor
        level = quiet["open_centre.boost_scale"] * np.expm1(
            quiet["open_centre.boost_rate"] * torque
        )
        return quiet.with_values(
            {
                "open_centre.boost_rate": rate,
                "open_centre.boost_scale": level / np.expm1(rate * torque),
            }
        )

    def predicted(factor: float) -> bool:
        changed = steeper(factor)
        return growth(open_centre_point(changed, torque), changed).real > 0.0

    def simulated(factor: float) -> bool:
        return grows(steeper(factor), torque, 0.0)

    low, high = 0.5, 6.0
    at = bisected(predicted, low, high, 14)
    pole = growth(open_centre_point(steeper(at), torque), quiet)
    return Onset(
        "boost curve's rate",
        torque,
        "times the data sheet's",
        at,
        bisected(simulated, low, high, 7),
        abs(pole.imag) / (2.0 * np.pi),
    )


def motion_onset(parameters: ParameterSet, torque: float = 3.0) -> Onset:
    """Return the rack speed against the assistance [m/s] at which a held torque [N m] chatters."""
    quiet = without_friction(parameters)
    area = quiet["mechanics.piston_area"]

    def predicted(speed: float) -> bool:
        try:
            return growth(open_centre_point(quiet, torque, -area * speed), quiet).real > 0.0
        except ParameterError:
            return True

    fastest = 0.9 * quiet["open_centre.pump_flow"] / area
    at = bisected(predicted, 1e-3, fastest, 14)
    pole = growth(open_centre_point(quiet, torque, -area * at), quiet)
    return Onset(
        "motion against the assistance",
        torque,
        "m/s of the rack",
        at,
        bisected(lambda speed: grows(quiet, torque, -speed), 1e-3, fastest, 7),
        abs(pole.imag) / (2.0 * np.pi),
    )


def grows(parameters: ParameterSet, torque: float, speed: float) -> bool:
    """Return whether a kicked, free wheel's oscillation grows at a rack speed [m/s]."""
    pressure = load_pressure_after_kick(parameters, torque, speed)
    if pressure is None:
        return True
    # Smooth motion has no second differences; what is left is the oscillation near 80 Hz.
    shake = np.abs(np.diff(pressure, 2))
    third = len(shake) // 3
    return bool(shake[-third:].max() > shake[:third].max())


def load_pressure_after_kick(
    parameters: ParameterSet, torque: float, speed: float, duration: float = LONGEST
) -> np.ndarray | None:
    """Return the load pressure [Pa] each ms after a kick of the wheel; None where it breaks off.

    Driver's torque and load stay constant; the rack starts so that it passes its middle half-way.
    """
    p, area = parameters.group("mechanics"), parameters["mechanics.piston_area"]
    point = open_centre_point(parameters, torque, area * speed)
    # The run ends before the rack has left the middle half of its stroke.
    reach = 0.4 * p["rack_stop_position"]
    duration = min(duration, 2.0 * reach / abs(speed)) if speed else duration
    plant = Plant(parameters, "open_centre")
    y, start = plant.state, -0.5 * speed * duration
    y[states.POSITION], y[states.VELOCITY] = start, speed
    y[states.ANGLE] = torque / p["torsion_bar_stiffness"] + p["gear_ratio"] * start
    y[states.SPEED] = p["gear_ratio"] * speed + DISTURBANCE
    y[states.LEFT], y[states.RIGHT], y[states.PUMP] = point.left, point.right, point.pump
    applied = torque + p["steering_wheel_damping"] * p["gear_ratio"] * speed
    load = area * point.load_pressure + torque * p["gear_ratio"] - p["rack_damping"] * speed
    rows = []
    for tick in range(round(duration * 1000.0)):
        rows.append(y[states.RIGHT] - y[states.LEFT])
        try:
            plant.step(tick, applied, 0.0, 0.0, load, 0.0, 0.0)
        except PlantError:
            return None
    return np.array(rows)


def bisected(passes: Callable[[float], bool], low: float, high: float, steps: int) -> float:
    """Return about where ``passes`` turns true between low and high, halving in the logarithm."""
    for _ in range(steps):
        middle = float(np.sqrt(low * high))
        low, high = (low, middle) if passes(middle) else (middle, high)
    return float(np.sqrt(low * high))
