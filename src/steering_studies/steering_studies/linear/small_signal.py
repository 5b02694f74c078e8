"""Small-signal responses of the nonlinear simulation, identified with a multisine.

Friction is off, as in the linear models. The wheel is held by a driver's spring and damper around
the operating point, so that nothing drifts; the responses are ratios of measured signals, which
the driver does not enter.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from pressure_control.controller import ValveController
from pressure_control.operating_point import steering_point
from pressure_control.state_places import INTEGRAL
from pressure_control.valve_static import holding_demand
from steering_core.parameters import ParameterSet
from steering_core.ticks import TICK_PERIOD
from steering_plant.boost_curve import FORMULA
from steering_plant.linear.gear import linear_gear
from steering_plant.linear.open_centre import open_centre_point
from steering_plant.model import states
from steering_plant.plant import Plant

PERIOD = 2000
"""Ticks of the multisine's period: lines at multiples of 0.5 Hz."""

LOCKED = 1e10
"""Stiffness [N/m] that holds the rack."""

HOLD_GAIN, HOLD_LEAD = 100.0, 0.025
"""The driver's spring [N m/rad] and the lead [s] of its damping."""


@dataclass(frozen=True)
class SmallSignal:
    """Responses at ``frequency`` [Hz] (n,), complex: load pressure over torque [Pa/(N m)], and
    R_T x over the steering wheel angle."""

    frequency: np.ndarray
    pressure_by_torque: np.ndarray
    rack_by_wheel: np.ndarray


def without_friction(parameters: ParameterSet) -> ParameterSet:
    """Return the parameters with all friction elements off and equal, fine inner steps."""
    return parameters.with_values(
        {
            "mechanics.column_friction": 0.0,
            "mechanics.rack_friction": 0.0,
            "mechanics.rack_friction_pressure_slope": 0.0,
            "simulation.inner_steps": 20.0,
        }
    )


def lines(highest: float = 100.0, count: int = 30) -> np.ndarray:
    """Return the multisine's line numbers, about evenly spaced in the logarithm, 1 to highest."""
    wanted = np.logspace(0.0, np.log10(highest * PERIOD * TICK_PERIOD), count)
    return np.unique(np.round(wanted).astype(int))


def multisine(numbers: np.ndarray, ticks: int) -> np.ndarray:
    """Return a sum of unit sines at the lines with Schroeder's phases, shape (ticks,)."""
    k = np.arange(len(numbers))
    phase = -np.pi * k * (k - 1) / len(numbers)
    angle = 2.0 * np.pi / PERIOD * np.outer(np.arange(ticks), numbers) + phase
    return np.cos(angle).sum(axis=1)


def small_signal(
    parameters: ParameterSet,
    valve_system: str,
    torque: float,
    *,
    stiffness: float | None = None,
    amplitude: float = 2e-3,
    highest: float = 100.0,
    settle: int = 2000,
) -> SmallSignal:
    """Run the nonlinear gear around a held torque [N m] and return its small-signal responses.

    valve_system: "open_centre" or "closed_centre" (with both controllers). stiffness [N/m]: of
    the load; LOCKED holds the rack. amplitude [N m]: of each line of the driver's torque.
    """
    quiet = without_friction(parameters)
    gear = linear_gear(quiet, stiffness)
    plant = Plant(quiet, valve_system)
    sides = _controllers(quiet, valve_system)
    load = _place(quiet, plant, sides, torque)
    wheel = torque / gear.K_T
    numbers = lines(highest)
    excitation = amplitude * multisine(numbers, settle + PERIOD)
    rows = np.empty((settle + PERIOD, 9))
    for tick in range(settle + PERIOD):
        measured = plant.observe(tick).copy()
        rows[tick] = measured
        left, right = (float(side.step(tick, *measured)[1]) for side in sides) if sides else (0, 0)
        held = torque - HOLD_GAIN * (measured[0] - wheel + HOLD_LEAD * measured[1])
        plant.step(tick, held + excitation[tick], left, right, load, gear.stiffness, 0.0)
    spectrum = np.fft.rfft(rows[settle:], axis=0)[numbers]
    return SmallSignal(
        numbers / (PERIOD * TICK_PERIOD),
        (spectrum[:, 4] - spectrum[:, 3]) / spectrum[:, 2],
        gear.R_T * spectrum[:, 6] / spectrum[:, 0],
    )


def _controllers(parameters: ParameterSet, valve_system: str) -> list[ValveController]:
    if valve_system == "open_centre":
        return []
    return [ValveController(parameters, side) for side in ("left", "right")]


def _place(
    parameters: ParameterSet, plant: Plant, sides: list[ValveController], torque: float
) -> float:
    """Put plant and controllers at rest at a torque [N m]; return the load [N] that balances."""
    p, y = parameters.group("mechanics"), plant.state
    y[states.ANGLE] = torque / p["torsion_bar_stiffness"]
    if sides:
        point = steering_point(parameters, FORMULA, torque, 0.0, 0.0)
        right, left = (chamber.valve for chamber in point.chambers)
        y[states.LEFT], y[states.RIGHT] = left.pressure, right.pressure
        for side, first, valve in zip(
            sides, (states.LEFT_VALVE, states.RIGHT_VALVE), (left, right), strict=True
        ):
            y[first + states.SPOOL] = valve.displacement
            y[first + states.CONTROL] = valve.pressure
            side.state[INTEGRAL] = holding_demand(parameters, valve)
    else:
        open_point = open_centre_point(parameters, torque)
        y[states.LEFT], y[states.RIGHT] = open_point.left, open_point.right
        y[states.PUMP] = open_point.pump
    plant.observe(0)
    difference = float(y[states.RIGHT] - y[states.LEFT])
    return p["piston_area"] * difference + torque * p["gear_ratio"]
