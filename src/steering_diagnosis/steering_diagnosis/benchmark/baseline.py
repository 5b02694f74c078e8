"""A simple, honest diagnosis to compare with: least squares on three balances of forces.

Columns are measured, so each balance is a linear regression. Of the effects' signatures the one
that takes away most of a balance's error beyond what tolerances explain is named. It knows nothing
of flows and valves, of several effects, and of ambiguity.
"""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
from scipy.signal import butter, sosfiltfilt

from steering_diagnosis.data.channels import CHANNELS
from steering_diagnosis.data.read import read_record
from steering_diagnosis.data.record import PERIOD_S, Record
from steering_diagnosis.steering.drive import MOVING
from steering_diagnosis.steering.smoothing import bridged

CUTOFF_HZ = 15.0
NAMED_FROM = 0.5
"""Share of a balance's error that a signature must take away."""

Column = tuple[str, str, float, float, np.ndarray]
"""Effect, parameter, neutral value, scale of the coefficient's deviation, signature."""


def baseline(path: Path, mapping: Path | None = None) -> dict[str, Any]:
    """Return a report's verdict and causes for a bag, or a file with its mapping."""
    record = read_record(path, mapping)
    best: tuple[float, str, Column, float, float] | None = None
    for balance, error, columns, tolerances in balances(record):
        own = _left(error, tolerances)
        if np.mean(own**2) < 1e-30:
            continue
        for column in columns:
            signature = _left(column[4], tolerances)
            power = float(signature @ signature)
            if power < 1e-20:
                continue
            size = float(signature @ own) / power
            share = size * size * power / float(own @ own)
            spread = np.sqrt(float(own @ own) * max(1.0 - share, 0.0) / len(own) * 50.0 / power)
            if best is None or share > best[0]:
                best = (share, balance, column, size, float(spread))
    if best is None or best[0] < NAMED_FROM:
        return {"schema": 1, "verdict": "clean", "causes": [], "unexplained": []}
    _, balance, (effect, parameter, neutral, scale, _), size, spread = best
    value, width = neutral + size * scale, 1.96 * spread * abs(scale)
    estimate = {"value": value, "low": value - width, "high": value + width, "unit": ""}
    cause = {
        "effect": effect,
        "ambiguous_with": [],
        "balance": balance,
        "parameters": {parameter: estimate},
    }
    return {"schema": 1, "verdict": "named", "causes": [cause], "unexplained": []}


def balances(record: Record) -> list[tuple[str, np.ndarray, list[Column], np.ndarray]]:
    """Return name, error (n,), signatures and tolerance columns (n, k) of each balance.

    A balance that needs a channel which was not measured is left out.
    """
    p = record.nominal
    smooth = _all_smooth(record)
    x, v, force = (smooth[name] for name in ("rack_position", "rack_speed", "rack_force"))
    angle, omega, torque = (
        smooth[n] for n in ("steering_wheel_angle", "steering_wheel_speed", "torsion_bar_torque")
    )
    left, right = smooth["left_pressure"], smooth["right_pressure"]
    ratio, bar = p["mechanics.gear_ratio"], p["mechanics.torsion_bar_stiffness"]
    area, one = p["mechanics.piston_area"], np.ones(len(x))
    sliding, turning = np.tanh(v / 1e-3), np.tanh(omega / 0.05)
    acceleration = np.gradient(v, PERIOD_S)
    level, slope = p["mechanics.rack_friction"], p["mechanics.rack_friction_pressure_slope"]
    twist = angle - ratio * x
    rack = area * (right - left) + ratio * torque - force - p["mechanics.rack_mass"] * acceleration
    rack -= p["mechanics.rack_damping"] * v + (level + slope * (left + right)) * sliding
    # What acts until a tick was commanded at the tick before.
    asked, stiffness, at = (
        np.roll(smooth[f"load_{n}"], 1) for n in ("force", "stiffness", "position")
    )
    load = force - asked - stiffness * (x - at)
    load[0] = 0.0
    column = (
        smooth["driver_torque"]
        - torque
        - p["mechanics.steering_wheel_inertia"] * np.gradient(omega, PERIOD_S)
    )
    column -= (
        p["mechanics.steering_wheel_damping"] * omega + p["mechanics.column_friction"] * turning
    )
    bar_columns: list[Column] = [
        ("torque_sensor_gain", "gain", 1.0, 1.0, torque),
        ("torque_sensor_offset", "offset", 0.0, 1.0, one),
        ("torque_sensor_delay", "delay", 0.0, -1.0, np.gradient(torque, PERIOD_S)),
        ("angle_sensor_delay", "delay", 0.0, 1.0, bar * omega),
        ("rack_backlash", "gap", 0.0, -2.0 / bar, np.tanh(torque / 0.05)),
    ]
    rack_columns: list[Column] = [
        ("rack_mass", "added", 0.0, 1.0, acceleration),
        ("rack_viscous_damping", "added", 0.0, 1.0, v),
        ("rack_friction_level", "factor", 1.0, 1.0 / level, sliding),
        ("rack_friction_pressure_slope", "factor", 1.0, 1.0 / slope, sliding * (left + right)),
        ("rack_friction_asymmetry", "coulomb", 0.0, 2.0, one),
        ("rack_force_sensor_gain", "gain", 1.0, -1.0, force),
        ("rack_stribeck_friction", "breakaway", 0.0, 1.0, sliding / (1.0 + (v / 3e-3) ** 2)),
    ]
    load_columns: list[Column] = [
        ("load_cylinder_friction", "level", 0.0, 1.0, sliding),
        (
            "tyre_relaxation",
            "relaxation_length",
            0.0,
            -p["vehicle.speed"],
            np.gradient(force, PERIOD_S),
        ),
    ]
    friction = p["mechanics.column_friction"]
    column_columns: list[Column] = [("column_friction", "factor", 1.0, 1.0 / friction, turning)]
    pressed = 0.01 * area * (right - left)
    loss, stack = 0.3 * p["mechanics.rack_damping"] * v, np.column_stack
    loose = 0.15 * (level + slope * (left + right)) * sliding
    found = [
        ("torsion bar", torque - bar * twist, bar_columns, stack([0.03 * torque, 0.13 * one])),
        ("rack force", rack, rack_columns, stack([pressed, 20.0 * one, loose, loss])),
        ("load", load, load_columns, stack([5e-3 * force, 10.0 * one])),
        ("column torque", column, column_columns, stack([0.02 * one])),
    ]
    return [balance for balance in found if np.isfinite(balance[1]).all()]


def _all_smooth(record: Record) -> dict[str, np.ndarray]:
    """Return every channel, smooth, (n,); NaN where there is none, speeds from their positions."""
    nothing = np.full(len(record), np.nan)
    found = {n: _smooth(bridged(record[n])) if n in record else nothing for n in CHANNELS}
    for position, speed in MOVING.items():
        if speed not in record and position in record:
            found[speed] = np.gradient(found[position], PERIOD_S)
    return found


def _smooth(values: np.ndarray) -> np.ndarray:
    sections = butter(2, 2.0 * CUTOFF_HZ * PERIOD_S, output="sos")
    return np.asarray(sosfiltfilt(sections, values, padlen=min(300, len(values) - 1)))


def _left(values: np.ndarray, tolerances: np.ndarray) -> np.ndarray:
    """Return ``values`` without what the tolerances take up, each within twice its own size."""
    q, r = np.linalg.qr(tolerances)
    coefficients = np.linalg.solve(r, q.T @ values)
    return np.asarray(values - tolerances @ np.clip(coefficients, -2.0, 2.0))
