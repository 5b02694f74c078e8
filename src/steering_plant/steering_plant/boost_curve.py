"""The open-centre valve's static map: boost curve, opening areas, pressures at any load flow.

The valve is a Wheatstone bridge whose opposite orifices are equal. A1 connects the pump with the
right chamber and the left chamber with the tank and opens with positive torque; A2 is its mirror
image. The boost curve, measured without load flow at a reference pump flow and oil, fixes the
closing area; the opening one runs smoothly from the centre opening to the largest opening.
"""

from __future__ import annotations

import math

import numpy as np

from steering_core.compiled import kernel
from steering_core.parameters import ParameterError, ParameterSet, record

FORMULA = np.zeros((0, 5))
"""The boost table that stands for the data sheet's formula."""


@kernel
def boost_pressure(p, table, torque):
    """Return the static load pressure [Pa] at zero load flow for a torsion-bar torque [N m].

    With an empty ``table`` boost_scale (exp(boost_rate |T|) - 1) with the torque's sign, continued
    linearly above boost_linear_above; otherwise the table's piecewise cubic (measured_boost_curve).
    """
    if table.shape[0] > 0:
        return _cubic(table, torque)
    size = abs(torque)
    knee = min(size, p.boost_linear_above)
    growth = math.exp(p.boost_rate * knee)
    pressure = p.boost_scale * (growth - 1.0 + growth * p.boost_rate * (size - knee))
    return math.copysign(pressure, torque)


@kernel
def opening_areas(p, table, torque):
    """Return the bridge's areas (A1, A2) [m2] at a torsion-bar torque [N m] (eq. 4.7, 4.8).

    The opening area grows as centre + (maximum - centre) tanh(|T|/opening_torque); the closing one
    follows from the boost pressure at the reference flow. Positive torque opens A1.
    """
    pressure = abs(boost_pressure(p, table, torque))
    widening = math.tanh(abs(torque) / p.opening_torque)
    wide = p.centre_opening + (p.maximum_opening - p.centre_opening) * widening
    narrow = wide / math.sqrt(1.0 + pressure * wide * wide / p.bridge_constant)
    if torque >= 0.0:
        return wide, narrow
    return narrow, wide


@kernel
def static_pressures(p, table, torque, load_flow):
    """Return the static pressures (right, left) [Pa] at a torque [N m] and load flow [m3/s].

    load_flow is the flow into the right chamber (A_p x'). Equations 4.5 and 4.6 with the areas in
    the order of 4.3: right and left are half the sum and half the difference of pump and load
    pressure. Valid for a load flow within the pump flow; the tank is at zero pressure.
    """
    a1, a2 = opening_areas(p, table, torque)
    ratio = load_flow / p.pump_flow
    factor = p.density * p.pump_flow**2 / (8.0 * p.flow_coefficient**2)
    towards_low = (1.0 - ratio) / a2
    towards_high = (1.0 + ratio) / a1
    # p_s = factor (towards_low^2 + towards_high^2), p_L = factor (towards_low^2 - towards_high^2)
    return factor * towards_low * towards_low, factor * towards_high * towards_high


@kernel
def _cubic(table, torque):
    row = min(max(np.searchsorted(table[:, 0], torque, side="right") - 1, 0), table.shape[0] - 1)
    at = torque - table[row, 0]
    return ((table[row, 1] * at + table[row, 2]) * at + table[row, 3]) * at + table[row, 4]


def valve_constants(parameters: ParameterSet, table: np.ndarray = FORMULA) -> dict[str, float]:
    """Return the constants that kernels need beside the data sheet.

    bridge_constant [N m2] = rho q^2/(8 C_q^2) of the boost curve's measurement; opening_torque
    [N m]: scale of the opening law, such that the area is smooth through zero torque.
    Raises ParameterError where the areas are impossible.
    """
    p = parameters.group("open_centre")
    flow, density = p["boost_reference_flow"], p["boost_reference_density"]
    constant = density * flow**2 / (8.0 * p["boost_reference_flow_coefficient"] ** 2)
    centre, widest = p["centre_opening"], p["maximum_opening"]
    if widest <= centre:
        raise ParameterError("open_centre.maximum_opening must exceed open_centre.centre_opening")
    slope = _slope_at_centre(parameters, table)
    area_slope = slope * centre**3 / (4.0 * constant)
    return {"bridge_constant": constant, "opening_torque": (widest - centre) / area_slope}


def boost_record(parameters: ParameterSet, table: np.ndarray = FORMULA) -> np.ndarray:
    """Return the record, shape (1,), that the kernels of this module take as ``p = record[0]``."""
    return record(
        parameters.group("oil")
        | parameters.group("open_centre")
        | valve_constants(parameters, table)
    )


def _slope_at_centre(parameters: ParameterSet, table: np.ndarray) -> float:
    if len(table) == 0:
        return parameters["open_centre.boost_scale"] * parameters["open_centre.boost_rate"]
    width = 0.05
    rise = _cubic(table, width) - _cubic(table, -width)
    if rise <= 0.0:
        raise ParameterError("the boost curve must rise through zero torque")
    return float(rise / (2.0 * width))
