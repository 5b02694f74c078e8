"""Pressure control with servo valves, linear (source, section 7.2, 7.5 to 7.15), continuous.

Signs are derived again: a load flow into the chamber's cylinder lowers the pressure, so (7.12)
has a minus before its disturbance. Both valves of a chamber move together, so K_q and K_c are the
sums of both edges'.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from pressure_control.record import controller_record
from pressure_control.reference import reference_pressures
from steering_core.parameters import ParameterError, ParameterSet
from steering_core.ticks import TICK_PERIOD
from steering_plant.boost_curve import FORMULA
from steering_plant.linear.gear import Assistance


@dataclass(frozen=True)
class LinearServo:
    """One chamber and its two servo valves at an operating point, SI units.

    command: share of the stroke by which meter-in opens more than the bias. K_q [m3/s] by command,
    K_c [m3/(s Pa)], C_s = V/beta [m3/Pa]; w_v [rad/s], d_v: of the spools.
    """

    pressure: float
    command: float
    K_q: float
    K_c: float
    C_s: float
    w_v: float
    d_v: float

    def responses(self, s: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Return chamber pressure over command [Pa] and over load flow [Pa s/m3] (7.8)."""
        chamber = 1.0 / (self.K_c + self.C_s * s)
        spool = 1.0 / ((s / self.w_v) ** 2 + 2.0 * self.d_v * s / self.w_v + 1.0)
        return self.K_q * spool * chamber, -chamber


def linear_servo(
    parameters: ParameterSet, pressure: float, load_flow: float = 0.0, rack_position: float = 0.0
) -> LinearServo:
    """Linearise one chamber at a pressure [Pa] and load flow [m3/s] out of its valves.

    Raises ParameterError outside of the supply's range or where the flow needs more than the bias.
    """
    p, oil = parameters.group("servo_valve"), parameters.group("oil")
    supply = parameters["closed_centre.supply_pressure"]
    if not 0.0 < pressure < supply:
        raise ParameterError(f"the pressure {pressure:g} Pa is not within 0 to {supply:g}")
    full = oil["flow_coefficient"] * p["full_opening"] * math.sqrt(2.0 / oil["density"])
    inward, outward = full * math.sqrt(supply - pressure), full * math.sqrt(pressure)
    bias = p["bias_opening"]
    command = (load_flow - bias * (inward - outward)) / (inward + outward)
    open_in, open_out = max(bias + command, 0.0), max(bias - command, 0.0)
    if min(open_in, open_out) == 0.0:
        raise ParameterError(f"at {load_flow:g} m3/s one of the servo valves is closed")
    volume = parameters["open_centre.chamber_volume"]
    volume += parameters["mechanics.piston_area"] * rack_position
    return LinearServo(
        pressure,
        command,
        inward + outward,
        0.5 * (open_in * inward / (supply - pressure) + open_out * outward / pressure),
        volume / oil["bulk_modulus"],
        p["resonance"],
        p["damping"],
    )


def servo_controller(
    parameters: ParameterSet,
    servo: LinearServo,
    s: np.ndarray,
    sampled: bool = True,
    delay: int = 0,
) -> np.ndarray:
    """Return command over control error [1/Pa] (7.15), ideally matched to the chamber.

    K_p0 C_s/K_q (T s + 1)/(T s + gamma) (T_d s + 1)/(alpha T_d s + 1), T = C_s/K_c. sampled: with
    the hold of one tick and ``delay`` ticks.
    """
    p = parameters.group("servo_valve")
    slow, lead = servo.C_s / servo.K_c, p["lead_time"]
    gain = p["controller_gain"] * servo.C_s / servo.K_q
    lag = (slow * s + 1.0) / (slow * s + p["lag_ratio"])
    response = gain * lag * (lead * s + 1.0) / (p["lead_ratio"] * lead * s + 1.0)
    return response * hold(s, delay) if sampled else response


def hold(s: np.ndarray, delay: int = 0) -> np.ndarray:
    """Return the response of a hold over one tick with ``delay`` ticks before it."""
    before = np.exp(-s * TICK_PERIOD)
    return (1.0 - before) / (s * TICK_PERIOD) * before**delay


def servo_assistance(
    parameters: ParameterSet,
    torque: float,
    omega: np.ndarray,
    *,
    sampled: bool = True,
    delay: int = 0,
    table: np.ndarray = FORMULA,
) -> Assistance:
    """Return the load pressure of both chambers (7.12) at a torsion-bar torque [N m]."""
    p = controller_record(parameters, "right", table)[0]
    supply, area = float(p["supply_pressure"]), float(p["piston_area"])
    share = parameters["servo_valve.flow_feed_forward"]
    raised = parameters["servo_valve.common_pressure_raise"]
    s = 1j * np.asarray(omega, float)
    before = np.exp(-s * TICK_PERIOD)
    slip = float(p["slip_weight"])
    lowpass = slip / (1.0 - (1.0 - slip) * before)
    total = [np.zeros(len(s), complex) for _ in range(3)]
    for sign, static in zip((1.0, -1.0), _static(p, table, torque, supply), strict=True):
        pressure, by_torque, by_speed = static
        servo = linear_servo(parameters, pressure + raised)
        by_command, by_flow = servo.responses(s)
        compensator = servo_controller(parameters, servo, s, sampled, delay)
        loop = by_command * compensator
        held = hold(s, delay) if sampled else np.ones(len(s))
        forward = share * sign * area / servo.K_q * held
        parts = (
            loop * by_torque,
            loop * by_speed * lowpass + by_flow * sign * area,
            loop * by_speed * (1.0 - lowpass) + by_command * forward,
        )
        total = [t + sign * part / (1.0 + loop) for t, part in zip(total, parts, strict=True)]
    return Assistance(np.asarray(omega, float), *total)


def _static(
    p: np.void, table: np.ndarray, torque: float, supply: float
) -> list[tuple[float, float, float]]:
    """Return pressure, slope by torque and by rack speed of the right and left reference."""
    area, dt, dv = float(p["piston_area"]), 1e-3, 1e-4

    def pressures(at_torque: float, speed: float) -> np.ndarray:
        right, load = reference_pressures(p, table, at_torque, area * speed, supply)
        return np.array([right, right - load])

    steady = pressures(torque, 0.0)
    by_torque = (pressures(torque + dt, 0.0) - pressures(torque - dt, 0.0)) / (2.0 * dt)
    by_speed = (pressures(torque, dv) - pressures(torque, -dv)) / (2.0 * dv)
    raised = float(p["common_pressure_raise"])
    return [
        (float(a) - raised, float(b), float(c))
        for a, b, c in zip(steady, by_torque, by_speed, strict=True)
    ]
