"""Balance residuals: each equation of the model with the measured signals put into it.

All channels go through one zero-phase low-pass, so that both sides of an equation are filtered
alike and derivatives are those of smooth curves. Every measured state is prescribed to the plant's
own right-hand side; only what no sensor sees is integrated: friction elements, spools, control
chambers. What the right-hand side then gives as a state's rate, less the measured rate, is the
error that enters at this balance and at no other.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from steering_diagnosis.steering.clamped import (
    ANGLE,
    CHAMBERS,
    POSITION,
    TORQUE,
    Clamped,
    torques,
)
from steering_diagnosis.steering.drive import RUN_UP
from steering_diagnosis.steering.outputs import (
    driver_torque_error,
    load_force_error,
    rack_force_error,
)


@dataclass(frozen=True)
class Balance:
    """A balance: its residual and the size of the terms in it, (n,), or None without channels."""

    name: str
    unit: str
    needs: tuple[str, ...]
    residual: Callable[[Clamped], np.ndarray]
    scale: Callable[[Clamped], np.ndarray]
    systems: tuple[str, ...] = ("open_centre", "closed_centre", "servo_valve")


def _torsion_bar(c: Clamped) -> np.ndarray:
    drive, parameters = c.run.drive, c.run.parameters
    angle, position = c.measured("steering_wheel_angle"), c.measured("rack_position")
    model = torques(c.simulation, parameters, c.run.effects, angle, position)
    return drive.felt("torsion_bar_torque", parameters)[RUN_UP:] - model


def _rack(c: Clamped) -> np.ndarray:
    p, trace = c.run.parameters, c.run.trace
    acceleration = c.measured("rack_position", 2)
    missing = 0.0 if c.torque is None else c.torque - trace.torque
    mass, ratio = p["mechanics.rack_mass"], p["mechanics.gear_ratio"]
    return mass * (acceleration - trace.rate("rack_speed")) - ratio * missing


def _chamber(side: str) -> Callable[[Clamped], np.ndarray]:
    def residual(c: Clamped) -> np.ndarray:
        lacking = c.measured(f"{side}_pressure", 1) - c.run.trace.rate(f"{side}_pressure")
        return _capacity(c, side) * lacking

    return residual


def _capacity(c: Clamped, side: str) -> np.ndarray:
    p = c.run.parameters
    sign = -1.0 if side == "left" else 1.0
    swept = sign * p["mechanics.piston_area"] * c.run.trace["rack_position"]
    return (p["open_centre.chamber_volume"] + swept) / p["oil.bulk_modulus"]


def _pump(c: Clamped) -> np.ndarray:
    p = c.run.parameters
    lacking = c.measured("supply_pressure", 1) - c.run.trace.rate("pump_pressure")
    return p["open_centre.pump_volume"] / p["oil.bulk_modulus"] * lacking


def _supply(c: Clamped) -> np.ndarray:
    return c.measured("supply_pressure") - c.run.trace.supply


def _valve(c: Clamped) -> np.ndarray:
    free = c.with_free_pressures()
    return _load_pressure(c) - (free["right_pressure"] - free["left_pressure"])


def _load_pressure(c: Clamped) -> np.ndarray:
    return c.measured("right_pressure") - c.measured("left_pressure")


def _rate_of(speed: str, position: str) -> Callable[[Clamped], np.ndarray]:
    def residual(c: Clamped) -> np.ndarray:
        by = c.run.drive.felt_raw(speed, c.run.parameters)
        return c.run.drive.as_smooth_as(position, by) - c.measured(position, 1)

    return residual


def _load(c: Clamped) -> np.ndarray:
    return c.run.drive.as_smooth_as("rack_force", rack_force_error(c.run))


def _tyres(c: Clamped) -> np.ndarray:
    return c.run.drive.as_smooth_as("rack_position", load_force_error(c.run))


LOAD = ("rack_force", "load_force", "load_stiffness", "load_position", POSITION)


def _column_terms(c: Clamped) -> np.ndarray:
    return np.asarray(c.run.drive.record["driver_torque"])


def _rack_terms(c: Clamped) -> np.ndarray:
    return _load_pressure(c) * c.run.parameters["mechanics.piston_area"]


def _flow_terms(c: Clamped) -> np.ndarray:
    return c.run.parameters["mechanics.piston_area"] * c.measured(POSITION, 1)


BALANCES = (
    Balance(
        "column torque",
        "N m",
        ("driver_torque", TORQUE),
        lambda c: driver_torque_error(c.run),
        _column_terms,
    ),
    Balance("torsion bar", "N m", (TORQUE, POSITION), _torsion_bar, lambda c: c.measured(TORQUE)),
    Balance("rack force", "N", (POSITION, TORQUE, "rack_force", *CHAMBERS), _rack, _rack_terms),
    Balance(
        "left chamber continuity", "m3/s", (POSITION, *CHAMBERS), _chamber("left"), _flow_terms
    ),
    Balance(
        "right chamber continuity", "m3/s", (POSITION, *CHAMBERS), _chamber("right"), _flow_terms
    ),
    Balance("valve flow", "Pa", (POSITION, TORQUE, *CHAMBERS), _valve, _load_pressure),
    Balance("supply", "m3/s", ("supply_pressure", *CHAMBERS), _pump, _flow_terms, ("open_centre",)),
    Balance(
        "supply",
        "Pa",
        ("supply_pressure", *CHAMBERS),
        _supply,
        lambda c: c.measured("supply_pressure"),
        ("closed_centre", "servo_valve"),
    ),
    Balance("load", "N", LOAD, _load, lambda c: c.measured("rack_force")),
    Balance("tyre", "N", LOAD, _tyres, lambda c: c.measured("rack_force")),
    Balance(
        "angle sensor",
        "rad/s",
        ("steering_wheel_speed",),
        _rate_of("steering_wheel_speed", ANGLE),
        lambda c: c.measured(ANGLE, 1),
    ),
    Balance(
        "rack position sensor",
        "m/s",
        ("rack_speed", POSITION),
        _rate_of("rack_speed", POSITION),
        lambda c: c.measured(POSITION, 1),
    ),
)
"""All balances; a record has those whose channels it has."""
