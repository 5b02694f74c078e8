"""The record of constants that the servo valves' controller reads."""

from __future__ import annotations

import math
from typing import Any

import numpy as np

from pressure_control.lead import sampled_lead
from pressure_control.record import Side
from steering_core.compiled import kernel
from steering_core.parameters import ParameterSet, record
from steering_core.ticks import TICK_PERIOD
from steering_plant.boost_curve import FORMULA, valve_constants
from steering_plant.orifice import orifice_flow, orifice_flow_gain
from steering_plant.plant import SERVO_FIELDS, plant_record
from steering_plant.rest import closed_centre_rest_pressure, rest_servo_command

GROUPS = ("mechanics", "oil", "open_centre", "valve_controller")


@kernel
def flow_gain(p: Any, pressure: float, supply: float) -> float:
    """Return K_q = K_q1 + K_q2 [m3/s] of a chamber's two valves, for commands as a share (7.8)."""
    full = p.orifice_constant * p.servo_full_opening
    transition = p.laminar_transition_pressure
    inward = orifice_flow(full, supply - pressure, transition)
    return inward + orifice_flow(full, pressure, transition)


def servo_controller_record(
    parameters: ParameterSet, side: Side, table: np.ndarray = FORMULA
) -> np.ndarray:
    """Return the record, shape (1,), that ``servo_controller.controller_step`` takes as ``par``.

    Beside the data sheet's: controller_conductance [m3/(s Pa)] = K_p0 of (7.15), its sampled lag
    (lag_weight, lag_leak) and lead (lead_gain, lead_zero, lead_pole), and rest_command.
    """
    servo = parameters.group("servo_valve")
    values: dict[str, float] = {}
    for group in GROUPS:
        values |= parameters.group(group)
    values |= valve_constants(parameters, table)
    values |= {f"servo_{name}": servo[full] for name, full in SERVO_FIELDS.items()}
    values |= {f"test_{name}": v for name, v in parameters.group("pressure_test").items()}
    values["supply_pressure"] = parameters["closed_centre.supply_pressure"]
    values["common_pressure_raise"] = servo["common_pressure_raise"]
    values["flow_feed_forward"] = servo["flow_feed_forward"]
    values["orifice_constant"] = values["flow_coefficient"] * math.sqrt(2.0 / values["density"])
    lowpass = values["velocity_lowpass"]
    values["slip_weight"] = -math.expm1(-TICK_PERIOD / lowpass) if lowpass > 0.0 else 1.0
    values["side"] = 1.0 if side == "right" else -1.0

    plant = plant_record(parameters, "servo_valve", table)
    pressure = closed_centre_rest_pressure(plant, table, servo["common_pressure_raise"])
    values["rest_command"] = rest_servo_command(plant[0], pressure)
    capacitance = values["chamber_volume"] / values["bulk_modulus"]
    values["controller_conductance"] = servo["controller_gain"] * capacitance
    values |= _lag(servo["lag_ratio"], capacitance / flow_pressure_coefficient(plant[0], pressure))
    zero_rate = 1.0 / servo["lead_time"]
    lead = sampled_lead(zero_rate, zero_rate / servo["lead_ratio"])
    values |= dict(zip(("lead_gain", "lead_zero", "lead_pole"), lead, strict=True))
    return record(values)


def rest_flow_pressure(parameters: ParameterSet, table: np.ndarray = FORMULA) -> float:
    """Return K_c [m3/(s Pa)] of a chamber's two valves at the common pressure of rest."""
    plant = plant_record(parameters, "servo_valve", table)
    raised = parameters["servo_valve.common_pressure_raise"]
    pressure = closed_centre_rest_pressure(plant, table, raised)
    return flow_pressure_coefficient(plant[0], pressure)


def flow_pressure_coefficient(p: np.void, pressure: float) -> float:
    """Return K_c = K_c1 + K_c2 [m3/(s Pa)] of a chamber's two valves at rest (7.5, 7.6)."""
    command, transition = rest_servo_command(p, pressure), p["laminar_transition_pressure"]
    full = p["orifice_constant"] * p["servo_full_opening"]
    inward = full * (p["servo_bias"] + command)
    outward = full * (p["servo_bias"] - command)
    drop = p["supply_pressure"] - pressure
    gain = orifice_flow_gain(inward, drop, transition)
    return float(gain + orifice_flow_gain(outward, pressure, transition))


def _lag(ratio: float, time: float) -> dict[str, float]:
    """Return the weights of the lag's state, x' = ((1 - ratio) e - ratio x)/time, over a tick."""
    if ratio == 0.0:
        return {"lag_weight": TICK_PERIOD / time, "lag_leak": 0.0}
    leak = -math.expm1(-ratio * TICK_PERIOD / time)
    return {"lag_weight": leak * (1.0 - ratio) / ratio, "lag_leak": leak}
