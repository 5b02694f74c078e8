"""The record of constants that the controller's kernels read."""

from __future__ import annotations

import math
from typing import Literal

import numpy as np

from pressure_control.schedule import schedule_fields
from pressure_control.valve_gains import valve_fields
from steering_core.parameters import ParameterSet, record
from steering_core.ticks import TICK_PERIOD
from steering_plant.boost_curve import FORMULA, valve_constants

Side = Literal["left", "right"]

GROUPS = (
    "mechanics",
    "oil",
    "open_centre",
    "closed_centre",
    "pressure_control_valve",
    "valve_controller",
)


def controller_record(
    parameters: ParameterSet, side: Side, table: np.ndarray = FORMULA
) -> np.ndarray:
    """Return the record, shape (1,), that ``controller_step`` takes as ``par``.

    Beside the data sheet's groups: side (+1 right, -1 left), slip_weight (velocity_lowpass over
    one tick), torque_weight (torque_lowpass), resonance_fall_rate [1/Pa], and the constants of
    valve, schedule and boost curve.
    """
    values: dict[str, float] = {}
    for group in GROUPS:
        values |= parameters.group(group)
    values |= valve_constants(parameters, table) | valve_fields(parameters)
    values |= schedule_fields(parameters)
    fall = values["resonance_fall_pressure"]
    values["slip_weight"] = lowpass_weight(values["velocity_lowpass"])
    values["torque_weight"] = lowpass_weight(values["torque_lowpass"])
    values["resonance_fall_rate"] = 1.0 / fall if fall > 0.0 else 0.0
    values["side"] = 1.0 if side == "right" else -1.0
    return record(values)


def lowpass_weight(time: float) -> float:
    """Return what a low-pass of a time constant [s] takes in over one tick; 1 without one."""
    return -math.expm1(-TICK_PERIOD / time) if time > 0.0 else 1.0
