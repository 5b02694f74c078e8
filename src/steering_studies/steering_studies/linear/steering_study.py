"""The steering loop with pressure control valves and with servo valves (figs 6.11 to 7.7)."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from pressure_control.linear_assistance import Manner, closed_centre_assistance, pressure_loop_gain
from pressure_control.linear_servo import servo_assistance
from pressure_control.operating_point import SteeringPoint, steering_point
from steering_core.parameters import ParameterSet
from steering_plant.boost_curve import FORMULA
from steering_plant.linear.gear import Assistance, linear_gear
from steering_studies.linear.bode import TORQUES, Family, family

SMALL_SPEED = 1e-7
"""Half width [m/s] of slopes by speed: inside the underlap, as small signals are."""


def data_sheet_manner(parameters: ParameterSet, **changes: object) -> Manner:
    """Return the controller as the parameters have it, sampled, with ``changes`` of Manner."""
    p = parameters.group("valve_controller")
    return Manner(p["resonance"], p["damping"], **changes)  # type: ignore[arg-type]


def small_signal_point(parameters: ParameterSet, torque: float) -> SteeringPoint:
    """Return the closed-centre loop at standstill and a torque [N m], for small signals."""
    return steering_point(parameters, FORMULA, torque, 0.0, 0.0, SMALL_SPEED)


def valve_loop_gain(parameters: ParameterSet, manner: Manner | None = None) -> Family:
    """Return the loop gain of the right chamber's pressure control (6.7), low to high torque."""
    chosen = manner or data_sheet_manner(parameters)

    def response(torque: float, omega: np.ndarray) -> np.ndarray:
        point = small_signal_point(parameters, torque)
        return pressure_loop_gain(point, point.chambers[0], chosen, omega)

    title = "pressure loop with controller"
    return family("6.8", title, response, frequency=_below_nyquist(), is_loop=True)


def closed_centre_loop_gain(
    parameters: ParameterSet, manner: Manner | None = None, stiffness: float | None = None
) -> Family:
    """Return fig 6.11: wheel angle to rack with pressure control valves, loop open."""
    title = "pressure control valves: loop gain"
    return _loop(parameters, "6.11", title, _closed_centre(parameters, manner), stiffness)


def closed_centre_closed_loop(
    parameters: ParameterSet, manner: Manner | None = None, stiffness: float | None = None
) -> Family:
    """Return fig 6.12: wheel angle to R_T x with pressure control valves (6.13)."""
    opened = closed_centre_loop_gain(parameters, manner, stiffness)
    return _closed(opened, "6.12", "pressure control valves: closed loop")


def servo_loop_gain(
    parameters: ParameterSet,
    stiffness: float | None = None,
    *,
    sampled: bool = True,
    delay: int = 0,
) -> Family:
    """Return fig 7.6: wheel angle to rack with servo valves, loop open."""

    def responses(torque: float, omega: np.ndarray) -> Assistance:
        return servo_assistance(parameters, torque, omega, sampled=sampled, delay=delay)

    return _loop(parameters, "7.6", "servo valves: loop gain", responses, stiffness)


def servo_closed_loop(
    parameters: ParameterSet,
    stiffness: float | None = None,
    *,
    sampled: bool = True,
    delay: int = 0,
) -> Family:
    """Return fig 7.7: wheel angle to R_T x with servo valves (7.14)."""
    opened = servo_loop_gain(parameters, stiffness, sampled=sampled, delay=delay)
    return _closed(opened, "7.7", "servo valves: closed loop")


def _closed_centre(
    parameters: ParameterSet, manner: Manner | None
) -> Callable[[float, np.ndarray], Assistance]:
    chosen = manner or data_sheet_manner(parameters)

    def responses(torque: float, omega: np.ndarray) -> Assistance:
        return closed_centre_assistance(small_signal_point(parameters, torque), chosen, omega)

    return responses


def _loop(
    parameters: ParameterSet,
    figure: str,
    title: str,
    responses: Callable[[float, np.ndarray], Assistance],
    stiffness: float | None,
) -> Family:
    gear = linear_gear(parameters, stiffness)

    def response(torque: float, omega: np.ndarray) -> np.ndarray:
        return gear.loop_gain(responses(torque, omega))

    return family(
        figure, title, response, torques=TORQUES, frequency=_below_nyquist(), is_loop=True
    )


def _closed(opened: Family, figure: str, title: str) -> Family:
    response = opened.response / (1.0 + opened.response)
    return Family(figure, title, opened.frequency, opened.torque, response)


def _below_nyquist() -> np.ndarray:
    """Return frequencies [Hz] up to just below half the sampling rate."""
    return np.logspace(-1.0, np.log10(490.0), 400)
